// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <type_traits>
#include <vector>

#include "host_mesh.h"
#include "lapedit/edit/edit.h"

/// Between MeshLab's mesh and the core's. Everything here is in the layer's own coordinates: the layer's transform
/// (CMeshO::Tr) is neither read nor changed.
namespace lapedit::host {

constexpr StoredScalar kStoredScalar = std::is_same_v<Scalarm, float> ? StoredScalar::Float : StoredScalar::Double;

/// The vertices and faces of a host mesh that are not deleted, in their order.
struct BridgedMesh {
  TriangleMesh mesh;
  std::vector<int> host_vertex;  ///< vertex of mesh -> place in CMeshO::vert
  std::vector<int> core_vertex;  ///< place in CMeshO::vert -> vertex of mesh, -1 if deleted
};

/// Readers of hosts make faces of any numbers that are in a file: nothing may walk over them before.
/// @throws EditError (BadIndex) if a face or an edge names a vertex that is not there; O(faces + edges)
void require_sound_corners(const CMeshO& host);

/// O(vertices + faces). A face on a deleted vertex gets a corner -1, which validate() refuses.
/// @throws EditError (BadIndex) as require_sound_corners() does
BridgedMesh read_mesh(const CMeshO& host);

/// Numbers of vertices of the bridged mesh, ascending.
std::vector<int> selected_vertices(const CMeshO& host, const BridgedMesh& bridged);
std::vector<int> vertices_of_selected_faces(const CMeshO& host, const BridgedMesh& bridged);

/// Gives vertices their new places, then brings up to date what follows from them: the normals of the faces at moved
/// vertices, those of these faces' corners, and the bounding box. What did not move keeps its bits, and so does
/// everything else in the mesh. Normals are those of the host's own update (unit length for faces, sums weighted by
/// angle for vertices), but never NaN: faces without area or with a non-finite corner give none, and a face or vertex
/// that gets none keeps the one it had. The box leaves non-finite vertices out.
/// @param host  the mesh that bridged was read from, with the same vertices and faces
void write_positions(CMeshO& host, const BridgedMesh& bridged, const EditResult& result);

/// Length of the diagonal of the box around all finite vertices; 0 if there is none.
double finite_diagonal(const CMeshO& host);

}  // namespace lapedit::host
