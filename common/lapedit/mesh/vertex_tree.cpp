// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_tree.h"

#include <algorithm>

#include "lapedit/mesh/surface_index.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

VertexTree::VertexTree(const Points& points, std::vector<int> vertices, const std::vector<int>* labels)
    : points_(points), labels_(labels) {
  for (const int k : order_by_position(gather(points, vertices))) {
    vertices_.push_back(vertices[static_cast<std::size_t>(k)]);
  }
  if (!vertices_.empty()) {
    build(0, static_cast<int>(vertices_.size()));
  }
}

int VertexTree::nearest(const Vector3& position, double limit) const {
  constexpr double kFar = 1e150;  // its square is finite
  limit = std::min(limit, kFar);
  std::size_t looks = 0;
  const auto any = [](int) { return true; };
  return nearest(position, limit * limit, kNoLabel, any, looks, vertices_.size() + 1).vertex;
}

/// Halves the vertices along the curve, and bounds them from the leaves up.
int VertexTree::build(int first, int last) {
  constexpr int kLeaf = 8;
  const auto number = nodes_.size();
  const int begin = vertices_[first];
  const Vector3 position = points_.row(begin).transpose();
  Node node = {position, position, first, last, -1, label(begin), begin};
  nodes_.push_back(node);
  const auto add = [&node](const Vector3& low, const Vector3& high, int label, int lowest) {
    node.low = node.low.cwiseMin(low);
    node.high = node.high.cwiseMax(high);
    node.label = label == node.label ? label : kNoLabel;
    node.lowest = std::min(node.lowest, lowest);
  };
  if (last - first > kLeaf) {
    const int middle = first + (last - first) / 2;
    const int left = build(first, middle);
    node.right = build(middle, last);
    for (const int child : {left, node.right}) {
      add(nodes_[child].low, nodes_[child].high, nodes_[child].label, nodes_[child].lowest);
    }
  } else {
    for (int k = first; k < last; ++k) {
      const int v = vertices_[k];
      add(points_.row(v).transpose(), points_.row(v).transpose(), label(v), v);
    }
  }
  nodes_[number] = node;
  return static_cast<int>(number);
}

}  // namespace lapedit
