// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/adjacency.h"
#include "lapedit_host/face_shape.h"
#include "lapedit_host/mesh_bridge.h"

namespace lapedit::host {

/// Writes poses into a host mesh again and again, at the cost of what moves and not of the mesh, and can bring back the
/// mesh's first state to the bit.
///
/// The mesh after write() depends only on the positions of all vertices, not on the way there: positions are those
/// given, with the first bits where they are equal to the first ones (zeros of the other sign); normals of faces with a
/// vertex away from its first place, and of these faces' corners, are as write_positions() makes them; all other
/// normals, and the box of a mesh all of whose vertices are in their first place, are what they were at first, bit for
/// bit.
class PoseWriter {
 public:
  /// Copies positions, normals and box of the host mesh. O(vertices + faces).
  /// @param bridged    read_mesh(host); only the map of its vertices is kept
  /// @param adjacency  of bridged.mesh; must outlive the object
  PoseWriter(const CMeshO& host, const BridgedMesh& bridged, const Adjacency& adjacency);

  /// @return false, and nothing is written, if the host mesh has other numbers of vertices and faces than at
  ///         construction, or other positions at these vertices than those written last: somebody else changed it
  /// @param host       the mesh of construction, in the same place of memory or not
  /// @param vertices   vertex numbers of the bridged mesh, each once
  /// @param positions  one row per entry of vertices
  /// @param settled    whether to bring the bounding box up to date, which takes a pass over all vertices
  /// Cost: O(faces at these vertices and at their neighbours); with the same vertices as the last time nothing is
  /// allocated, but for the threads that share a large region.
  bool write(CMeshO& host, const std::vector<int>& vertices, const Points& positions, bool settled);

  /// Whether vertices and faces of the host are still those of construction, and its positions those of the last
  /// write(). O(vertices + faces).
  bool matches(const CMeshO& host) const;

 private:
  bool has_same_size(const CMeshO& host) const;

  struct MeasuredFace {
    FaceShape shape;
    bool has_shape, is_away;
  };

  bool is_away(int face) const;
  void find_affected(const std::vector<int>& vertices);
  void write_faces(CMeshO& host);
  void write_vertices(CMeshO& host);

  const Adjacency& adjacency_;
  std::vector<int> host_vertex_, host_face_;
  Faces faces_;  // of the bridged mesh
  std::size_t host_vertices_, host_faces_;
  std::vector<Point3m> first_, now_, first_normals_, first_face_normals_;
  Box3m first_box_;
  std::vector<char> away_;  // per vertex: has it other bits than at first
  int away_count_ = 0;

  // Affected by the last set of vertices.
  std::vector<int> vertices_;           // that set
  std::vector<int> touched_;            // it and the corners of the faces at it
  std::vector<char> is_touched_;        // per vertex
  std::vector<int> around_;             // all faces at those
  std::vector<MeasuredFace> measured_;  // per entry of around_
  std::vector<int> place_;              // mesh face -> entry of around_, -1 elsewhere
  ThreadPool pool_{0};
};

}  // namespace lapedit::host
