// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <vector>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A grid of cubes over some vertices that finds near ones in O(1). There are about twice as many cubes as vertices.
class VertexGrid {
 public:
  /// @param vertices  with finite coordinates; points are not copied and must outlive the object
  VertexGrid(const Points& points, std::vector<int> vertices);

  /// Returns the vertex nearest to a point, the lowest number of several; -1 if none is within the limit.
  /// @param accept  bool(int vertex): whether a vertex is considered
  template <class Accept>
  int nearest(const Vector3& position, double limit, const Accept& accept) const {
    int found = -1;
    double best = limit * limit;
    const std::array<int, 3> middle = cube_at(position);
    const int rings = *std::max_element(counts_.begin(), counts_.end());
    // Rings of cubes farther than the nearest vertex found, or than the limit, are skipped.
    for (int ring = 0; ring <= rings && (ring == 0 || nearest_of_ring(position, middle, ring) <= best); ++ring) {
      for_ring(middle, ring, [&](int cube) {
        for (int k = offsets_[cube]; k < offsets_[cube + 1]; ++k) {
          const int v = vertices_[k];
          const double squared = (points_.row(v).transpose() - position).squaredNorm();
          if ((squared < best || (squared == best && (found < 0 || v < found))) && accept(v)) {
            best = squared;
            found = v;
          }
        }
      });
    }
    return found;
  }
  int nearest(const Vector3& position, double limit = std::numeric_limits<double>::max()) const {
    return nearest(position, limit < kFar ? limit : kFar, [](int) { return true; });
  }

 private:
  static constexpr double kFar = 1e150;  // its square is finite
  std::array<int, 3> cube_at(const Vector3& position) const;
  double nearest_of_ring(const Vector3& position, const std::array<int, 3>& middle, int ring) const;

  /// Visits the cubes of the grid at a Chebyshev distance.
  template <class Body>
  void for_ring(const std::array<int, 3>& middle, int ring, const Body& body) const {
    const auto low = [&](int k) { return std::max(0, middle[k] - ring); };
    const auto high = [&](int k) { return std::min(counts_[k] - 1, middle[k] + ring); };
    for (int z = low(2); z <= high(2); ++z) {
      for (int y = low(1); y <= high(1); ++y) {
        const bool whole_row = std::abs(z - middle[2]) == ring || std::abs(y - middle[1]) == ring;
        const int row = (z * counts_[1] + y) * counts_[0];
        if (whole_row) {
          for (int x = low(0); x <= high(0); ++x) {
            body(row + x);
          }
          continue;
        }
        for (const int x : {middle[0] - ring, middle[0] + ring}) {
          if (x >= 0 && x < counts_[0]) {
            body(row + x);
          }
        }
      }
    }
  }

  const Points& points_;
  Vector3 low_ = Vector3::Zero();
  double size_ = 1;  // of a cube
  std::array<int, 3> counts_{1, 1, 1};
  std::vector<int> offsets_, vertices_;  // cube by cube, ascending in each
};

}  // namespace lapedit
