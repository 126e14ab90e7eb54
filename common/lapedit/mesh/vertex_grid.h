// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
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
  int nearest(const Vector3& position, double limit = std::numeric_limits<double>::max()) const;

 private:
  static constexpr double kFar = 1e150;  // its square is finite
  std::array<int, 3> cube_at(const Vector3& position) const;
  double nearest_of_ring(const Vector3& position, const std::array<int, 3>& middle, int ring) const;

  const Points& points_;
  Vector3 low_ = Vector3::Zero();
  double size_ = 1;  // of a cube
  std::array<int, 3> counts_{1, 1, 1};
  std::vector<int> offsets_, vertices_;  // cube by cube, ascending in each
};

}  // namespace lapedit
