// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A tree of boxes over vertices that finds the nearest one, or the nearest one of another label. Boxes with vertices
/// of a single label are skipped whole, so the cost does not depend on how many vertices of that label are nearer.
class VertexTree {
 public:
  static constexpr int kNoLabel = -1;
  static constexpr std::size_t kMostLooks = 1024;

  /// @param vertices  with finite coordinates; points and labels are not copied and must outlive the object
  /// @param labels    per vertex of the mesh; null: all have the same
  /// O(vertices log vertices).
  VertexTree(const Points& points, std::vector<int> vertices, const std::vector<int>* labels = nullptr);

  struct Found {
    int vertex = -1;
    double squared;  ///< distance; the limit if no vertex was found
  };
  /// Returns the vertex nearest to a point, the lowest number of several; -1 if none is within the limit.
  int nearest(const Vector3& position, double limit = std::numeric_limits<double>::max()) const;
  /// Returns the vertex nearest to a point, the lowest number of several. After kMostLooks vertices, as from the centre
  /// of a sphere, it returns the nearest of those.
  /// @param limit   squared, of the distance
  /// @param except  vertices of this label are not considered
  /// @param accept  bool(int vertex): whether a vertex is considered
  /// @param looks   number of vertices that were looked at is added
  template <class Accept>
  Found nearest(const Vector3& position, double limit, int except, const Accept& accept, std::size_t& looks,
                std::size_t most_looks = kMostLooks) const {
    Found best{-1, limit};
    const auto is_nearer = [&best](double squared, int vertex) {
      return squared < best.squared || (squared == best.squared && (best.vertex < 0 || vertex < best.vertex));
    };
    struct Open {
      double squared;
      int node;
    };
    Open stack[64];  // at most one entry per level remains
    int open = 0;
    const auto push = [&](Open next) {
      if (nodes_[next.node].label != except || except == kNoLabel) {
        stack[open++] = next;
      }
    };
    const auto to_box = [&](int node) { return Open{squared_distance(position, nodes_[node]), node}; };
    if (!nodes_.empty()) {
      push(to_box(0));
    }
    for (const std::size_t last = looks + most_looks; open > 0 && looks < last;) {
      const Open next = stack[--open];
      const Node& node = nodes_[next.node];
      if (!is_nearer(next.squared, node.lowest)) {
        continue;
      }
      if (node.right < 0) {
        for (int k = node.first; k < node.last; ++k) {
          const int v = vertices_[k];
          const double squared = (points_.row(v).transpose() - position).squaredNorm();
          ++looks;
          if ((except == kNoLabel || label(v) != except) && is_nearer(squared, v) && accept(v)) {
            best = {v, squared};
          }
        }
        continue;
      }
      Open near = to_box(next.node + 1), far = to_box(node.right);
      if (std::pair(far.squared, nodes_[far.node].lowest) < std::pair(near.squared, nodes_[near.node].lowest)) {
        std::swap(near, far);
      }
      push(far);
      push(near);
    }
    return best;
  }

 private:
  struct Node {
    Vector3 low, high;
    int first, last;  // of vertices_
    int right = -1;   // second child, the first is the next node; -1: a leaf
    int label;        // of all vertices; kNoLabel: they have several
    int lowest;       // vertex
  };
  static double squared_distance(const Vector3& position, const Node& node) {
    return (position.cwiseMax(node.low).cwiseMin(node.high) - position).squaredNorm();
  }
  int label(int vertex) const { return labels_ ? (*labels_)[vertex] : 0; }
  int build(int first, int last);

  const Points& points_;
  const std::vector<int>* labels_;
  std::vector<int> vertices_;
  std::vector<Node> nodes_;
};

}  // namespace lapedit
