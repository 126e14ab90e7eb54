// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/mesh_summary.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

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
  const auto count = static_cast<std::size_t>(summary.vertices);
  Pieces pieces(count), borders(count);
  std::vector<char> used(count, 0);
  std::vector<std::pair<int, int>> edges;
  for (const auto& face : mesh.faces.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      const int a = face[k], b = face[(k + 1) % 3];
      used[a] = 1;
      pieces.join(a, b);
      if (a != b) {
        edges.emplace_back(std::min(a, b), std::max(a, b));
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  std::vector<char> at_border(count, 0);
  for (std::size_t k = 0, next = 0; k < edges.size(); k = next) {
    for (next = k; next < edges.size() && edges[next] == edges[k]; ++next) {
    }
    if (next == k + 1) {
      ++summary.border_edges;
      borders.join(edges[k].first, edges[k].second);
      at_border[edges[k].first] = at_border[edges[k].second] = 1;
    }
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
