// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <type_traits>
#include <vector>

#include "host_mesh.h"
#include "lapedit/edit/edit.h"

/// Converts between MeshLab's mesh and the core's, in the layer's own coordinates: the layer's transform (CMeshO::Tr)
/// is neither read nor changed.
namespace lapedit::host {

constexpr StoredScalar kStoredScalar = std::is_same_v<Scalarm, float> ? StoredScalar::Float : StoredScalar::Double;

/// The vertices and faces of a host mesh that are not deleted, in their order.
struct BridgedMesh {
  TriangleMesh mesh;
  std::vector<int> host_vertex;  ///< vertex of mesh -> index in CMeshO::vert
  std::vector<int> core_vertex;  ///< index in CMeshO::vert -> vertex of mesh, -1 if deleted
};

/// Checks that faces and edges name existing vertices, since MeshLab's readers accept any numbers. Callers call it
/// before they read faces. @throws EditError (BadIndex). O(faces + edges)
void require_sound_corners(const CMeshO& host);

/// Reads a mesh. A face on a deleted vertex gets a corner -1, which validate() refuses. O(vertices + faces).
/// @throws EditError (BadIndex) as require_sound_corners() does
BridgedMesh read_mesh(const CMeshO& host);

/// Returns vertex numbers of the bridged mesh, ascending. @param core_vertex  as in BridgedMesh
std::vector<int> selected_vertices(const CMeshO& host, const std::vector<int>& core_vertex);
std::vector<int> vertices_of_selected_faces(const CMeshO& host, const std::vector<int>& core_vertex);
/// Returns face numbers of the bridged mesh, ascending.
std::vector<int> selected_faces(const CMeshO& host);

inline bool is_finite(const Point3m& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

inline Vector3 to_core(const Point3m& point) {
  return {static_cast<double>(point[0]), static_cast<double>(point[1]), static_cast<double>(point[2])};
}

inline Point3m to_host(const Vector3& point) {
  return {static_cast<Scalarm>(point[0]), static_cast<Scalarm>(point[1]), static_cast<Scalarm>(point[2])};
}

/// Returns the layer's transform.
inline Eigen::Matrix4d transform_of(const CMeshO& host) {
  return Eigen::Map<const Eigen::Matrix<Scalarm, 4, 4, Eigen::RowMajor>>(host.Tr.V()).template cast<double>();
}

/// Returns the box around all finite vertices.
Box3m finite_box(const CMeshO& host);

/// Returns the length of that box's diagonal; 0 without finite vertices.
double finite_diagonal(const CMeshO& host);

}  // namespace lapedit::host
