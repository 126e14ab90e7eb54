// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {

/// Writes any number of poses into a host mesh, at a cost that depends on the moved vertices and not on the mesh, and
/// can restore the mesh's first state bit by bit. Normals and a box that other code sets where nothing has moved count
/// as first ones.
///
/// The mesh after write() depends only on the positions of all vertices, not on earlier poses. Positions are those
/// given; one that equals the first position keeps that one's bits, also the sign of a zero. Normals of faces with a
/// moved vertex, and of these faces' corners, are those of MeshLab's own update (unit length for faces, sums weighted
/// by angle for vertices), but never NaN: faces without area or with a non-finite corner contribute none, and a face or
/// vertex without contributions keeps its first normal. The box excludes non-finite vertices. All other normals, and
/// the box of a mesh without moved vertices, keep their first bits. Passing poses, the frames of a drag, get cheaper
/// vertex normals at and around the given vertices, of unit length and weighted by area, and the box is not updated.
class PoseWriter {
 public:
  /// Copies positions, normals and box of the host mesh. O(vertices + faces).
  /// @param bridged    read_mesh(host); only the map of its vertices is kept
  /// @param adjacency  of bridged.mesh; must outlive the object
  PoseWriter(const CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency);

  /// Writes a pose. @return false, without writing, if other code changed the host mesh: its numbers of vertices and
  ///         faces are not those of construction, or positions not those written last. After a settled pose it compares
  ///         all positions, otherwise those of these vertices
  /// @param host       the mesh of construction, also if it has moved in memory
  /// @param vertices   vertex numbers of the bridged mesh, each once
  /// @param positions  one row per entry of vertices
  /// @param settled    whether the pose is final; other vertices than in the last call settle the last pose, too
  /// Cost: O(faces at these vertices and at their neighbours), and a pass over all vertices if settled before or after;
  /// with other vertices than in the last call, a pass over one byte per vertex and face. With the same vertices only
  /// the first settled pose allocates.
  bool write(CMeshO& host, const std::vector<int>& vertices, const Points& positions, bool settled);

  /// Returns whether vertices and faces of the host mesh are still those of construction, and positions those of the
  /// last write(). O(vertices + faces).
  bool matches(const CMeshO& host) const;
  /// Compares only the numbers of vertices and faces, and the positions of some vertices. O(1).
  bool seems_to_match(const CMeshO& host) const;

 private:
  /// Current position, and whether its bits differ from the first ones.
  struct Corner {
    Point3m position;
    bool is_away;
  };

  /// The normal of a face: of unit length, or in a passing pose twice its area long.
  struct FaceNormal {
    Vector3 vector;
    bool has_area, is_away;
  };

  /// The vertices and faces that a pose of the last set of vertices changes.
  struct Affected {
    std::vector<int> vertices;                  // that set
    std::vector<int> touched;                   // that set and the corners of its faces, ascending
    std::vector<int> around;                    // all faces at touched vertices, ascending
    std::vector<FaceNormal> normals;            // per entry of around
    std::vector<std::array<double, 3>> angles;  // likewise, of a settled pose: those at its corners
    bool is_settled = true;
  };

  bool has_same_size(const CMeshO& host) const;
  bool is_ours(const CMeshO& host, int vertex) const;
  bool are_ours(const CMeshO& host, const std::vector<int>* vertices);  // null: all
  void find_affected(const std::vector<int>& vertices);
  void take_normals(const CMeshO& host);
  void write_places(CMeshO& host, const Points& positions);
  void write_normals(CMeshO& host, bool settled);

  const Adjacency& adjacency_;
  std::vector<int> host_vertex_, host_face_;
  Faces faces_;  // of the bridged mesh
  std::size_t host_vertices_, host_faces_;
  std::vector<Point3m> first_, first_normals_, first_face_normals_;
  Box3m first_box_;
  std::vector<Corner> now_;
  std::vector<int> away_;  // vertices that are away since the last settled pose
  Affected affected_;
  std::vector<int> position_;  // mesh face -> entry of affected_.around, if it is there
  ThreadPool pool_{0};
};

/// Writes one final pose. @param adjacency  of bridged.mesh
/// @throws EditError (MeshMismatch) if `bridged` was not read from this mesh. Cost: O(vertices + faces)
void write_positions(CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency, const EditResult& result);

}  // namespace lapedit::host
