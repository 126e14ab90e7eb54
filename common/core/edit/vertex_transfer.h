// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "lapedit/mesh/region.h"
#include "lapedit/mesh/vertex_tree.h"

namespace lapedit {

/// Positions of some vertices of a mesh, so that an edit of it can be applied to another mesh of the same object.
struct VertexPositions {
  std::vector<int> vertices;  ///< mesh vertex numbers, ascending
  std::vector<Vector3> points;
};

/// Finds the vertices of another mesh that replace those of the mesh that an edit was made for.
class VertexTransfer {
 public:
  /// All arguments but the finder must outlive the object. O(positions log positions)
  /// @throws EditError as VertexFinder::on_surface()
  VertexTransfer(const TriangleMesh& mesh, const Adjacency& adjacency, const VertexFinder& finder,
                 const VertexPositions& from);

  /// Returns the nearest vertex. @throws EditError (MeshMismatch) if the position is not listed
  int image(int vertex) const { return image_[row(vertex)]; }
  /// Returns the vertices that replace a set, ascending, each with the member of the set that it is nearest to: of each
  /// member the nearest vertex, and those around that are nearer to a member than to any other listed vertex.
  std::map<int, int> images(const std::vector<int>& set) const;
  /// Returns a region with its vertex set and kept anchors replaced. @throws EditError (BadParameter)
  RegionSpec images(RegionSpec region) const;

 private:
  std::size_t row(int vertex) const;
  std::optional<int> nearest_member(const std::vector<int>& members, int vertex) const;

  const TriangleMesh& mesh_;
  const Adjacency& adjacency_;
  const VertexPositions& from_;
  Points points_;
  std::vector<int> image_;
  std::optional<VertexTree> tree_;
};

}  // namespace lapedit
