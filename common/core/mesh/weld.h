// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// The vertices of a mesh that have equal coordinates, as at seams of texture coordinates, in triangle soups, and where
/// shells touch. The method takes vertices at the same place as one, the lowest of them, called the representative;
/// each of the others gets its position. Non-finite coordinates equal no others.
class Weld {
 public:
  Weld() = default;  ///< no two vertices at the same place
  /// O(vertices).
  explicit Weld(const Points& vertices);

  bool empty() const { return representative_.empty(); }
  /// Returns the representative of a vertex.
  int representative(int vertex) const { return empty() ? vertex : representative_[static_cast<std::size_t>(vertex)]; }
  /// Replaces vertices by their representatives. Numbers that are no vertices stay.
  void to_representatives(std::vector<int>& vertices) const;
  /// Returns the set of the representatives.
  std::vector<int> representatives(std::vector<int> vertices) const;
  /// Returns faces on representatives, so that the others have none.
  Faces faces(const Faces& faces) const;
  /// Adds the vertices that are at the places of the given ones.
  /// @param vertices  ascending; unchanged if there are no others
  /// @param rows      out: for each vertex, the index in the given list of the vertex at its place
  void add_others(std::vector<int>& vertices, std::vector<int>& rows) const;
  /// The same with their positions.
  void add_others(std::vector<int>& vertices, Points& positions) const;

 private:
  std::vector<int> representative_;  // per vertex; empty: each its own
};

/// The surface of a mesh, as an edit sees it: vertices at the same place are one, and each face counts once.
struct Joined {
  Weld weld;
  Faces faces;          ///< on representatives, see keep_distinct()
  Adjacency adjacency;  ///< of these
};

/// Returns the surface of a mesh; null if its own faces are that surface.
std::shared_ptr<const Joined> joined_surface(const TriangleMesh& mesh);

}  // namespace lapedit
