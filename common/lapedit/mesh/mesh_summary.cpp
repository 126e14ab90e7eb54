// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/triangle_mesh.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {
namespace {

/// Disjoint sets that can be joined.
class Pieces {
 public:
  explicit Pieces(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int v) {
    while (parent_[v] != v) {
      v = parent_[v] = parent_[parent_[v]];
    }
    return v;
  }
  void join(int a, int b) { parent_[root(a)] = root(b); }

 private:
  std::vector<int> parent_;
};

}  // namespace

MeshSummary summary_of(const TriangleMesh& mesh) {
  MeshSummary summary;
  summary.vertices = static_cast<int>(mesh.vertices.rows());
  summary.faces = static_cast<int>(mesh.faces.rows());
  summary.box = bounding_box(mesh.vertices);
  if (summary.faces > 0) {
    validate(mesh);
  }
  Faces faces = mesh.faces;
  keep_distinct(faces);
  summary.ignored = summary.faces - static_cast<int>(faces.rows());
  const auto count = static_cast<std::size_t>(summary.vertices);
  Pieces pieces(count), borders(count);
  std::vector<char> used(count, 0);
  for (const auto& face : faces.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      used[face[k]] = 1;
      pieces.join(face[k], face[(k + 1) % 3]);
    }
  }
  std::vector<char> at_border(count, 0);
  for (const auto& [a, b] : single_edges({faces.data(), faces.data() + faces.size()})) {
    ++summary.border_edges;
    borders.join(static_cast<int>(a), static_cast<int>(b));
    at_border[a] = at_border[b] = 1;
  }
  std::vector<int> sizes(count, 0);
  for (int v = 0; v < summary.vertices; ++v) {
    summary.loose += used[v] == 0 ? 1 : 0;
    summary.not_finite += mesh.vertices.row(v).allFinite() ? 0 : 1;
    summary.borders += at_border[v] != 0 && borders.root(v) == v ? 1 : 0;
    if (used[v] != 0) {
      summary.pieces += pieces.root(v) == v ? 1 : 0;
      summary.largest_piece = std::max(summary.largest_piece, ++sizes[pieces.root(v)]);
    }
  }
  return summary;
}

}  // namespace lapedit
