// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// The vertices of a mesh that are at the same place, to the bit but for the sign of a zero: seams of texture
/// coordinates, the corners of a triangle soup, shells that touch. The method takes them as one vertex, the lowest of
/// them, here called the first; each of the others gets its position. Vertices that are not finite are on their own.
class Weld {
 public:
  Weld() = default;  ///< no two vertices at the same place
  /// O(vertices).
  explicit Weld(const Points& vertices);

  bool empty() const { return first_.empty(); }
  int first(int vertex) const { return empty() ? vertex : first_[static_cast<std::size_t>(vertex)]; }
  /// Replaces vertices by the first at their places. Numbers that are no vertices stay.
  void to_first(std::vector<int>& vertices) const;
  /// Returns the set of the first vertices.
  std::vector<int> firsts(std::vector<int> vertices) const;
  /// Returns faces on first vertices, so that the others have none.
  Faces faces(const Faces& faces) const;
  /// Adds the vertices that are at the places of these. @param vertices  ascending, changed only if there are such
  /// @param rows  of each vertex its entry before
  void add_others(std::vector<int>& vertices, std::vector<int>& rows) const;
  /// The same with their positions.
  void add_others(std::vector<int>& vertices, Points& positions) const;

 private:
  std::vector<int> first_;  // per vertex; empty: each its own
};

/// A mesh whose vertices at the same place are one.
struct Joined {
  Weld weld;
  Faces faces;          ///< on first vertices; like the adjacency, empty if no two vertices are at the same place
  Adjacency adjacency;  ///< of these

  /// @param vertices  in place of the mesh's own
  Joined(const TriangleMesh& mesh, const Points& vertices) : weld(vertices) {
    if (!weld.empty()) {
      faces = weld.faces(mesh.faces);
      adjacency = build_adjacency(static_cast<int>(vertices.rows()), faces);
    }
  }
};

}  // namespace lapedit
