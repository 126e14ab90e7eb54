// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "lapedit/base/whole_part.h"

namespace lapedit {
namespace {

/// Visits the cubes of the grid at a Chebyshev distance.
template <class Body>
void for_ring(const std::array<int, 3>& counts, const std::array<int, 3>& middle, int ring, const Body& body) {
  const auto low = [&](int k) { return std::max(0, middle[k] - ring); };
  const auto high = [&](int k) { return std::min(counts[k] - 1, middle[k] + ring); };
  for (int z = low(2); z <= high(2); ++z) {
    for (int y = low(1); y <= high(1); ++y) {
      const bool whole_row = std::abs(z - middle[2]) == ring || std::abs(y - middle[1]) == ring;
      const int row = (z * counts[1] + y) * counts[0];
      if (whole_row) {
        for (int x = low(0); x <= high(0); ++x) {
          body(row + x);
        }
        continue;
      }
      for (const int x : {middle[0] - ring, middle[0] + ring}) {
        if (x >= 0 && x < counts[0]) {
          body(row + x);
        }
      }
    }
  }
}

}  // namespace

VertexGrid::VertexGrid(const Points& points, std::vector<int> vertices) : points_(points) {
  const Eigen::AlignedBox3d box = bounding_box(points, vertices);
  if (!vertices.empty()) {
    constexpr double kCubesPerVertex = 2, kFlat = 1e-3;  // of the longest side
    constexpr int kMost = 1 << 20;                       // cubes along a side
    low_ = box.min();
    const Vector3 half = box.max() / 2 - box.min() / 2;  // the whole may overflow, and so may the product of its sides
    const double longest = half.maxCoeff();
    if (longest > 0) {
      const double volume = (half / longest).cwiseMax(kFlat).prod();
      const double size = longest * std::cbrt(volume / (kCubesPerVertex * static_cast<double>(vertices.size())));
      size_ = std::clamp(2 * size, std::numeric_limits<double>::min(), std::numeric_limits<double>::max());
      for (int k = 0; k < 3; ++k) {
        counts_[k] = 1 + whole_part(half[k] / (size_ / 2), 0, kMost);
      }
    }
  }
  const auto number = [this, &points](int v) {
    const std::array<int, 3> cube = cube_at(points.row(v).transpose());
    return (std::clamp(cube[2], 0, counts_[2] - 1) * counts_[1] + std::clamp(cube[1], 0, counts_[1] - 1)) * counts_[0] +
           std::clamp(cube[0], 0, counts_[0] - 1);
  };
  std::sort(vertices.begin(), vertices.end());
  offsets_.assign(static_cast<std::size_t>(counts_[0]) * counts_[1] * counts_[2] + 1, 0);
  for (const int v : vertices) {
    ++offsets_[number(v) + 1];
  }
  for (std::size_t k = 1; k < offsets_.size(); ++k) {
    offsets_[k] += offsets_[k - 1];
  }
  vertices_.resize(vertices.size());
  std::vector<int> next = offsets_;
  for (const int v : vertices) {
    vertices_[next[number(v)]++] = v;
  }
}

/// Returns the cube of a position; for a position outside the grid, the nearest cube at its border.
std::array<int, 3> VertexGrid::cube_at(const Vector3& position) const {
  std::array<int, 3> cube{};
  for (int k = 0; k < 3; ++k) {
    cube[k] = whole_part((position[k] - low_[k]) / size_, 0, counts_[k] - 1);
  }
  return cube;
}

int VertexGrid::nearest(const Vector3& position, double limit) const {
  int found = -1;
  limit = std::min(limit, kFar);
  double best = limit * limit;
  const std::array<int, 3> middle = cube_at(position);
  const int rings = *std::max_element(counts_.begin(), counts_.end());
  // Rings of cubes farther than the nearest vertex found, or than the limit, are skipped.
  for (int ring = 0; ring <= rings && (ring == 0 || nearest_of_ring(position, middle, ring) <= best); ++ring) {
    for_ring(counts_, middle, ring, [&](int cube) {
      for (int k = offsets_[cube]; k < offsets_[cube + 1]; ++k) {
        const int v = vertices_[k];
        const double squared = (points_.row(v).transpose() - position).squaredNorm();
        if (squared < best || (squared == best && (found < 0 || v < found))) {
          best = squared;
          found = v;
        }
      }
    });
  }
  return found;
}

/// Returns a lower bound of the squared distance to the cubes of a ring and beyond.
double VertexGrid::nearest_of_ring(const Vector3& position, const std::array<int, 3>& middle, int ring) const {
  double gap = std::numeric_limits<double>::max();
  for (int k = 0; k < 3; ++k) {
    const double at = (position[k] - low_[k]) / size_;
    // Distance to those sides of the block of cubes inside the ring that have cubes beyond.
    if (middle[k] - ring >= 0) {
      gap = std::min(gap, at - (middle[k] - ring + 1));
    }
    if (middle[k] + ring < counts_[k]) {
      gap = std::min(gap, middle[k] + ring - at);
    }
  }
  constexpr double kRounding = 1e-9;
  gap = gap < std::numeric_limits<double>::max() ? std::max(0.0, gap - kRounding) * size_ : kFar;
  return gap * gap;
}

}  // namespace lapedit
