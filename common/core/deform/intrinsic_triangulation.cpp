// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/intrinsic_triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "lapedit/base/progress.h"
#include "lapedit/mesh/adjacency.h"

namespace lapedit {
namespace {

/// A triangulation that consists of lengths. Side s of face f, from corner s to the next one, has the number 3 f + s.
class IntrinsicTriangulation {
 public:
  IntrinsicTriangulation(const Points& points, const Faces& faces, const std::vector<Matrix3>* metric);

  void make_delaunay();
  SurfaceLaplacian laplacian() const;

 private:
  static int next(int side) { return side % 3 == 2 ? side - 2 : side + 1; }
  int end(int side) const { return corner_[next(side)]; }
  double area(int face) const { return area_[face]; }
  void measure(int face);
  double cotangent(int side) const;  // of the opposite angle
  void orient(const Faces& faces);
  void reverse(int face);
  void mollify();
  bool flip(int side);

  int vertices_;
  std::vector<int> corner_;     // per side: its first vertex
  std::vector<double> length_;  // per side
  std::vector<int> partner_;    // per side: the same edge in the other face, -1 on borders
  std::vector<double> area_;    // per face
};

IntrinsicTriangulation::IntrinsicTriangulation(const Points& points, const Faces& faces,
                                               const std::vector<Matrix3>* metric)
    : vertices_(static_cast<int>(points.rows())),
      corner_(3 * static_cast<std::size_t>(faces.rows())),
      length_(corner_.size()),
      partner_(paired_sides(vertices_, faces)),
      area_(static_cast<std::size_t>(faces.rows())) {
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int s = 0; s < 3; ++s) {
      const std::size_t side = 3 * static_cast<std::size_t>(f) + static_cast<std::size_t>(s);
      corner_[side] = faces(f, s);
      const int from = faces(f, s), to = faces(f, (s + 1) % 3);
      const Vector3 edge = (points.row(from) - points.row(to)).transpose();
      length_[side] = metric == nullptr
                          ? edge.norm()
                          : std::sqrt(std::max(0.5 * edge.dot((*metric)[from] * edge + (*metric)[to] * edge), 0.0));
    }
  }
  mollify();
  for (int face = 0; face < static_cast<int>(area_.size()); ++face) {
    measure(face);
  }
  orient(faces);
}

/// Adds the least length to all sides with which every triangle inequality holds by a small margin.
void IntrinsicTriangulation::mollify() {
  constexpr double kMargin = 1e-6;  // mean lengths
  const double mean = std::accumulate(length_.begin(), length_.end(), 0.0) / static_cast<double>(length_.size());
  double missing = 0;
  for (int side = 0; side < static_cast<int>(length_.size()); ++side) {
    const int second = next(side);
    missing = std::max(missing, kMargin * mean + length_[side] - length_[second] - length_[next(second)]);
  }
  for (double& length : length_) {
    length += missing;
  }
}

void IntrinsicTriangulation::reverse(int face) {
  const int a = 3 * face, b = a + 1, c = a + 2;
  std::swap(corner_[b], corner_[c]);
  std::swap(length_[a], length_[c]);
  std::swap(partner_[a], partner_[c]);
  for (const int side : {a, c}) {
    if (partner_[side] >= 0) {
      partner_[partner_[side]] = side;
    }
  }
}

/// Gives connected faces one orientation. Where that is impossible, cuts the edge.
void IntrinsicTriangulation::orient(const Faces& faces) {
  const std::vector<char> flips = flips_of(partner_, faces);
  for (int face = 0; face < static_cast<int>(flips.size()); ++face) {
    if (flips[face] != 0) {
      reverse(face);
    }
  }
  for (int side = 0; side < static_cast<int>(corner_.size()); ++side) {
    if (const int other = partner_[side]; other >= 0 && corner_[other] == corner_[side]) {
      partner_[side] = partner_[other] = -1;
    }
  }
}

/// Heron's formula in a form that is accurate for slivers (W. Kahan, Miscalculating area and angles of a needle-like
/// triangle, 2014).
void IntrinsicTriangulation::measure(int face) {
  const int side = 3 * face;
  double a = length_[side], b = length_[side + 1], c = length_[side + 2];
  if (a < b) {
    std::swap(a, b);
  }
  if (a < c) {
    std::swap(a, c);
  }
  if (b < c) {
    std::swap(b, c);
  }
  area_[face] = 0.25 * std::sqrt(std::max((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)), 0.0));
}

double IntrinsicTriangulation::cotangent(int side) const {
  const double opposite = length_[side], one = length_[next(side)], other = length_[next(next(side))];
  const double area_of_face = area(side / 3);
  return area_of_face > 0 ? (one * one + other * other - opposite * opposite) / (4 * area_of_face) : 0;
}

/// Replaces an inner edge by the other diagonal of its two faces, unfolded into a plane.
/// @return whether it was not a Delaunay edge
bool IntrinsicTriangulation::flip(int side) {
  constexpr double kTie = -1e-9;
  const int other = partner_[side];
  if (other < 0 || side / 3 == other / 3 || !(cotangent(side) + cotangent(other) < kTie)) {
    return false;
  }
  const int f = side / 3, g = other / 3;
  const int around[4] = {next(next(other)), next(side), next(next(side)), next(other)};  // d a, a c, c b, b d
  const double base = length_[side];
  double lengths[4], along[2], height[2];
  int corners[4], partners[4];
  for (int k = 0; k < 4; ++k) {
    lengths[k] = length_[around[k]];
    corners[k] = corner_[around[k]];
    partners[k] = partner_[around[k]];
  }
  // The two corners opposite to the edge, from its end a: the edge runs from b to a.
  along[0] = (base * base + lengths[1] * lengths[1] - lengths[2] * lengths[2]) / (2 * base);
  along[1] = (base * base + lengths[0] * lengths[0] - lengths[3] * lengths[3]) / (2 * base);
  height[0] = 2 * area(f) / base;
  height[1] = -2 * area(g) / base;
  const double diagonal =
      std::sqrt((along[0] - along[1]) * (along[0] - along[1]) + (height[0] - height[1]) * (height[0] - height[1]));
  const int now[4] = {3 * f, 3 * f + 1, 3 * g, 3 * g + 1};
  for (int& partner : partners) {  // of a side that is glued to another one of the same two faces
    const auto at = std::find(around, around + 4, partner) - around;
    partner = partner >= 0 && at < 4 ? now[at] : partner;
  }
  for (int k = 0; k < 4; ++k) {
    corner_[now[k]] = corners[k];
    length_[now[k]] = lengths[k];
    partner_[now[k]] = partners[k];
    if (partners[k] >= 0) {
      partner_[partners[k]] = now[k];
    }
  }
  corner_[3 * f + 2] = corners[2];
  corner_[3 * g + 2] = corners[0];
  length_[3 * f + 2] = length_[3 * g + 2] = diagonal;
  partner_[3 * f + 2] = 3 * g + 2;
  partner_[3 * g + 2] = 3 * f + 2;
  measure(f);
  measure(g);
  return true;
}

void IntrinsicTriangulation::make_delaunay() {
  std::vector<int> stack;
  std::vector<char> queued(corner_.size(), 0);
  const auto push = [&](int side) {
    if (queued[side] == 0) {
      queued[side] = 1;
      stack.push_back(side);
    }
  };
  for (int side = static_cast<int>(corner_.size()) - 1; side >= 0; --side) {
    if (partner_[side] > side) {
      push(side);
    }
  }
  Checkpoints checkpoints;
  while (!stack.empty()) {
    checkpoints();
    const int side = stack.back();
    stack.pop_back();
    queued[side] = 0;
    const int f = side / 3, g = partner_[side] / 3;
    if (flip(side)) {
      for (const int changed : {3 * f, 3 * f + 1, 3 * g, 3 * g + 1}) {
        push(changed);
      }
    }
  }
}

/// Areas are circumcentric: each face gives its corners a quarter of cot a l^2 for each side. Where the circumcentre is
/// beyond a border, half of the face belongs to the corner opposite to that border (M. Meyer et al., Discrete
/// differential-geometry operators, 2003), and the border, whose cotangent is negative, has no weight: the other two
/// sides get half the tangent of their angle with it, which has the same energy for functions that are linear along it.
SurfaceLaplacian IntrinsicTriangulation::laplacian() const {
  const auto sides = static_cast<int>(corner_.size());
  SurfaceLaplacian result;
  result.areas.setZero(vertices_);
  std::vector<int> offsets(static_cast<std::size_t>(vertices_) + 1, 0);
  for (int side = 0; side < sides; ++side) {
    ++offsets[corner_[side] + 1];
    ++offsets[end(side) + 1];
  }
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  std::vector<std::pair<int, double>> entries(2 * corner_.size());
  std::vector<int> at = offsets;
  for (int f = 0; f < sides / 3; ++f) {
    double halves[3];
    int beyond = -1;
    for (int s = 0; s < 3; ++s) {
      halves[s] = 0.5 * cotangent(3 * f + s);
      beyond = halves[s] < 0 && partner_[3 * f + s] < 0 ? s : beyond;
    }
    for (int s = 0; s < 3; ++s) {
      const int side = 3 * f + s, a = corner_[side], b = end(side);
      const double area_at_ends = beyond < 0 ? 0.25 * halves[s] * length_[side] * length_[side] : 0;
      result.areas[a] += beyond < 0 ? area_at_ends : area(f) * ((s + 1) % 3 == beyond ? 0.5 : 0.25);
      result.areas[b] += area_at_ends;
      const double weight = beyond < 0    ? halves[s]
                            : s == beyond ? 0
                                          : 0.25 / halves[s == next(beyond) ? next(s) : next(beyond)];
      entries[at[a]++] = {b, weight};
      entries[at[b]++] = {a, weight};
    }
  }
  constexpr double kMost = 1e3, kNone = 1e-7;  // weights; 1e3: the cotangent of 0.03 degrees
  result.neighbours.offsets.assign(1, 0);
  for (int i = 0; i < vertices_; ++i) {
    const auto first = entries.begin() + offsets[i], last = entries.begin() + offsets[i + 1];
    std::sort(first, last);
    for (auto entry = first; entry != last;) {
      const int j = entry->first;
      double weight = 0;
      for (; entry != last && entry->first == j; ++entry) {
        weight += entry->second;
      }
      if (j != i && weight > kNone) {
        result.neighbours.values.push_back(j);
        result.weights.push_back(std::min(weight, kMost));
      }
    }
    result.neighbours.offsets.push_back(static_cast<int>(result.neighbours.values.size()));
  }
  result.areas = result.areas.cwiseMax(0);
  return result;
}

}  // namespace

SurfaceLaplacian surface_laplacian(const Points& points, const Faces& faces, const std::vector<Matrix3>* metric) {
  IntrinsicTriangulation triangulation(points, faces, metric);
  triangulation.make_delaunay();
  return triangulation.laplacian();
}

}  // namespace lapedit
