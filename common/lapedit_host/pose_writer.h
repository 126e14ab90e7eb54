// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/adjacency.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {

/// Unit normal of a face, and the angles at its corners.
struct FaceShape {
  Vector3 normal;
  std::array<double, 3> angles;
};

/// Writes poses into a host mesh again and again, at the cost of what moves and not of the mesh, and can bring back the
/// mesh's first state to the bit.
///
/// The mesh after write() depends only on the positions of all vertices, not on the way there: positions are those
/// given, with the first bits where they are equal to the first ones (zeros of the other sign); normals of faces with a
/// vertex away from its first place, and of these faces' corners, are those of the host's own update (unit length for
/// faces, sums weighted by angle for vertices), but never NaN: faces without area or with a non-finite corner give
/// none, and a face or vertex that gets none keeps its first one. The box leaves non-finite vertices out. All other
/// normals, and the box of a mesh all of whose vertices are in their first place, are what they were at first, bit for
/// bit. A pose that is not settled is a picture that the next one follows: of the vertices given with it, and around
/// them, vertex normals are unit length and weighted by area, which takes no arc tangent, and the box waits.
class PoseWriter {
 public:
  /// Copies positions, normals and box of the host mesh. O(vertices + faces).
  /// @param bridged    read_mesh(host); only the map of its vertices is kept
  /// @param adjacency  of bridged.mesh; must outlive the object
  PoseWriter(const CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency);

  /// @return false, and nothing is written, if the host mesh has other numbers of vertices and faces than at
  ///         construction, or other positions at these vertices than those written last: other code changed it
  /// @param host       the mesh of construction, in the same place of memory or not
  /// @param vertices   vertex numbers of the bridged mesh, each once
  /// @param positions  one row per entry of vertices
  /// @param settled    whether the pose is there to stay; other vertices than the last time settle the last pose, too
  /// Cost: O(faces at these vertices and at their neighbours), and a pass over all vertices if settled; with other
  /// vertices than the last time, a pass over one byte per vertex and face. With the same ones nothing is allocated,
  /// but by the first settled pose.
  bool write(CMeshO& host, const std::vector<int>& vertices, const Points& positions, bool settled);

  /// Whether vertices and faces of the host are still those of construction, and its positions those of the last
  /// write(). O(vertices + faces).
  bool matches(const CMeshO& host) const;

 private:
  /// Place now, and whether it has other bits than at first.
  struct Corner {
    Point3m place;
    bool is_away;
  };

  struct MeasuredFace {
    FaceShape shape;
    bool has_shape, is_away;
  };

  /// Twice the area along the normal, zero if there is no such vector.
  struct AreaNormal {
    Vector3 vector;
    bool is_away;
  };

  /// By the last set of vertices.
  struct Affected {
    std::vector<int> vertices;           // that set
    std::vector<int> touched;            // it and the corners of the faces at it, ascending
    std::vector<int> around;             // all faces at those, ascending
    IndexLists faces;                    // entry of touched -> entries of around, ascending
    std::vector<AreaNormal> areas;       // per entry of around, of a passing pose
    std::vector<MeasuredFace> measured;  // likewise, of a settled one
    bool is_settled = true;
  };

  bool has_same_size(const CMeshO& host) const;
  bool is_ours(const CMeshO& host, const std::vector<int>& vertices);
  void find_affected(const std::vector<int>& vertices);
  void write_places(CMeshO& host, const Points& positions);
  void write_passing_normals(CMeshO& host);
  void write_settled_normals(CMeshO& host);
  Point3m& normal_of_vertex(CMeshO& host, int vertex) const;
  Point3m& normal_of_face(CMeshO& host, int face) const;

  const Adjacency& adjacency_;
  std::vector<int> host_vertex_, host_face_;
  Faces faces_;  // of the bridged mesh
  std::size_t host_vertices_, host_faces_;
  std::vector<Point3m> first_, first_normals_, first_face_normals_;
  Box3m first_box_;
  std::vector<Corner> now_;
  int away_count_ = 0;
  Affected affected_;
  std::vector<char> is_touched_, is_around_;  // per vertex and face: is it in affected_
  std::vector<int> place_;                    // mesh face -> entry of affected_.around, if it is there
  ThreadPool pool_{0};
};

/// Writes one pose that stays. @param adjacency  of bridged.mesh
/// @throws EditError (MeshMismatch) if `bridged` was not read from this mesh. Cost: O(vertices + faces)
void write_positions(CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency, const EditResult& result);

}  // namespace lapedit::host
