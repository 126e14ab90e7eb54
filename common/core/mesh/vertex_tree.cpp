// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_tree.h"

#include <algorithm>

namespace lapedit {

VertexTree::VertexTree(const Points& points, std::vector<int> vertices, const std::vector<int>* labels)
    : points_(points), labels_(labels), vertices_(std::move(vertices)) {
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

int VertexTree::build(int first, int last) {
  constexpr int kLeaf = 8;
  const auto number = nodes_.size();
  Node node;
  node.low = node.high = points_.row(vertices_[first]).transpose();
  node.first = first;
  node.last = last;
  node.label = label(vertices_[first]);
  node.lowest = vertices_[first];
  for (int k = first; k < last; ++k) {
    const int v = vertices_[k];
    node.low = node.low.cwiseMin(points_.row(v).transpose());
    node.high = node.high.cwiseMax(points_.row(v).transpose());
    node.label = label(v) == node.label ? node.label : kNoLabel;
    node.lowest = std::min(node.lowest, v);
  }
  nodes_.push_back(node);
  if (last - first > kLeaf) {
    Eigen::Index axis = 0;
    (node.high - node.low).maxCoeff(&axis);
    const auto begin = vertices_.begin() + first, end = vertices_.begin() + last;
    // Halves of the box are found faster, and are nearly as good where they are balanced.
    const double half = node.low[axis] / 2 + node.high[axis] / 2;
    auto middle = std::partition(begin, end, [&](int v) { return points_(v, axis) < half; });
    if (3 * std::min(middle - begin, end - middle) < end - begin) {
      middle = begin + (end - begin) / 2;
      std::nth_element(begin, middle, end,
                       [&](int a, int b) { return std::pair(points_(a, axis), a) < std::pair(points_(b, axis), b); });
    }
    const int split = static_cast<int>(middle - vertices_.begin());
    build(first, split);
    nodes_[number].right = build(split, last);
  }
  return static_cast<int>(number);
}

}  // namespace lapedit
