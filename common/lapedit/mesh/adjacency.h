// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// Concatenated lists of integers of different lengths: row i is values[offsets[i] .. offsets[i + 1]).
struct IndexLists {
  struct Row {
    const int* first;
    const int* last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
    int size() const { return static_cast<int>(last - first); }
  };

  std::vector<int> offsets{0};
  std::vector<int> values;

  int rows() const { return static_cast<int>(offsets.size()) - 1; }
  Row operator[](int row) const { return {values.data() + offsets[row], values.data() + offsets[row + 1]}; }
  /// Returns the index in `values` of a value of an ascending row.
  int entry(int row, int value) const {
    return static_cast<int>(std::lower_bound(values.begin() + offsets[row], values.begin() + offsets[row + 1], value) -
                            values.begin());
  }
};

/// The neighbours of all vertices of a mesh; built once per mesh, independent of its coordinates.
struct Adjacency {
  IndexLists neighbours;  ///< per vertex: the other ends of its edges, ascending, each once
  IndexLists faces;       ///< per vertex: the faces around it, ascending, each once
};

/// Builds the adjacency. Degenerate faces contribute only edges between different vertices. O(vertices + faces).
/// @param threads  0: as many as the machine has; the result does not depend on it
Adjacency build_adjacency(int vertex_count, const Faces& faces, int threads = 0);

/// Labels 0, 1, ... of the connected components of a graph with ascending rows and each edge in both, numbered by their
/// lowest vertex. @return their number
int connected_components(const IndexLists& neighbours, std::vector<int>& labels);

}  // namespace lapedit
