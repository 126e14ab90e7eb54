// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/surface_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace lapedit {
namespace {

constexpr int kLeaf = 4;

double squared_distance(const Vector3& point, const Vector3& low, const Vector3& high) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double outside = std::max(std::max(low[k] - point[k], point[k] - high[k]), 0.0);
    sum += outside * outside;
  }
  return sum;
}

/// Returns barycentric coordinates of the nearest point of a triangle (C. Ericson, Real-Time Collision Detection,
/// 5.1.5). A triangle without area has the regions of its corners and edges.
Vector3 nearest_weights(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) {
    return Vector3::UnitX();
  }
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) {
    return Vector3::UnitY();
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) {
    return Vector3::UnitZ();
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

}  // namespace

SurfaceTree::SurfaceTree(const Points& points, const Faces& faces) : points_(points), faces_(faces) {
  const int count = static_cast<int>(faces.rows());
  order_.resize(static_cast<std::size_t>(count));
  std::iota(order_.begin(), order_.end(), 0);
  Points centres(count, 3);
  for (int f = 0; f < count; ++f) {
    centres.row(f) = points.row(faces(f, 0)) + points.row(faces(f, 1)) + points.row(faces(f, 2));
  }
  nodes_.reserve(static_cast<std::size_t>(count));
  nodes_.emplace_back();
  split(0, 0, count, centres);
  slot_.resize(order_.size());
  for (int k = 0; k < count; ++k) {
    slot_[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])] = k;
  }
  triangles_.resize(order_.size());
  ThreadPool alone(1);
  refit(alone);
}

void SurfaceTree::split(int node, int first, int last, const Points& centres) {
  if (last - first <= kLeaf) {
    nodes_[static_cast<std::size_t>(node)].first = first;
    nodes_[static_cast<std::size_t>(node)].count = last - first;
    return;
  }
  Eigen::RowVector3d low = centres.row(order_[static_cast<std::size_t>(first)]), high = low;
  for (int k = first; k < last; ++k) {
    low = low.cwiseMin(centres.row(order_[static_cast<std::size_t>(k)]));
    high = high.cwiseMax(centres.row(order_[static_cast<std::size_t>(k)]));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](int a, int b) { return std::pair(centres(a, axis), a) < std::pair(centres(b, axis), b); });
  const int child = static_cast<int>(nodes_.size());
  nodes_[static_cast<std::size_t>(node)].first = child;
  nodes_[static_cast<std::size_t>(node)].count = 0;
  nodes_.resize(nodes_.size() + 2);
  split(child, first, middle, centres);
  split(child + 1, middle, last, centres);
}

void SurfaceTree::enclose(Node& node) {
  node.low.setConstant(std::numeric_limits<double>::max());
  node.high = -node.low;
  for (int k = node.first; k < node.first + node.count; ++k) {
    Triangle& triangle = triangles_[static_cast<std::size_t>(k)];
    triangle.face = order_[static_cast<std::size_t>(k)];
    for (int c = 0; c < 3; ++c) {
      triangle.corners[c] = points_.row(faces_(triangle.face, c)).transpose();
      node.low = node.low.cwiseMin(triangle.corners[c]);
      node.high = node.high.cwiseMax(triangle.corners[c]);
    }
  }
}

void SurfaceTree::refit(ThreadPool& pool) {
  constexpr int kGrain = 1024;
  const int count = static_cast<int>(nodes_.size());
  for_indices(pool, count, kGrain, [&](int k) {
    if (Node& node = nodes_[static_cast<std::size_t>(k)]; node.count > 0 || count == 1) {
      enclose(node);
    }
  });
  for (int k = count - 1; k >= 0; --k) {
    Node& node = nodes_[static_cast<std::size_t>(k)];
    if (node.count == 0 && count > 1) {
      const Node *const one = &nodes_[static_cast<std::size_t>(node.first)], *const other = one + 1;
      node.low = one->low.cwiseMin(other->low);
      node.high = one->high.cwiseMax(other->high);
    }
  }
}

void SurfaceTree::try_triangle(const Vector3& point, const Triangle& triangle, NearestPoint& best) const {
  const Vector3 &a = triangle.corners[0], &b = triangle.corners[1], &c = triangle.corners[2];
  const Vector3 weights = nearest_weights(point, a, b, c);
  const double squared = (weights[0] * a + weights[1] * b + weights[2] * c - point).squaredNorm();
  if (squared < best.squared || (squared == best.squared && triangle.face < best.face)) {
    best = {triangle.face, squared, weights};
  }
}

NearestPoint SurfaceTree::nearest(const Vector3& point, int hint) const {
  NearestPoint best;
  best.squared = std::numeric_limits<double>::infinity();
  if (hint >= 0) {
    try_triangle(point, triangles_[static_cast<std::size_t>(slot_[static_cast<std::size_t>(hint)])], best);
  }
  struct Open {
    int node;
    double squared;
  };
  Open stack[64];  // one per level, and there are fewer than 32
  int open = 0;
  stack[open++] = {0, 0};
  while (open > 0) {
    const Open next = stack[--open];
    if (next.squared > best.squared) {
      continue;
    }
    const Node& node = nodes_[static_cast<std::size_t>(next.node)];
    for (int k = node.first; k < node.first + node.count; ++k) {
      try_triangle(point, triangles_[static_cast<std::size_t>(k)], best);
    }
    if (node.count == 0 && nodes_.size() > 1) {
      const Node *const one = &nodes_[static_cast<std::size_t>(node.first)], *const other = one + 1;
      Open near = {node.first, squared_distance(point, one->low, one->high)};
      Open far = {node.first + 1, squared_distance(point, other->low, other->high)};
      if (far.squared < near.squared) {
        std::swap(near, far);
      }
      if (far.squared <= best.squared) {
        stack[open++] = far;
      }
      stack[open++] = near;
    }
  }
  return best;
}

Vector3 SurfaceTree::interpolated(const Points& rows, const NearestPoint& at) const {
  Vector3 sum = Vector3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (at.weights[k] != 0) {
      sum += at.weights[k] * rows.row(faces_(at.face, k)).transpose();
    }
  }
  return sum;
}

}  // namespace lapedit
