// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/cells/region_cells.h"

namespace lapedit {

/// A region's cells as a surface: how near neighbours are, normals, smoothing.
class CellSurface {
 public:
  /// @param cells  must outlive the object
  explicit CellSurface(const RegionCells& cells);

  /// How much an entry of cells.neighbours counts for what a cell's surroundings do.
  double nearness(int entry) const { return nearness_[entry]; }
  /// What an end's way adds to the gradient along the surface, in a basis of the cell's tangent plane.
  const Vector2& slope(int entry) const { return slope_[entry]; }
  /// The unit normal of the surface whose cells are at these places; zero where it has none.
  Vector3 normal(int cell, const Points& at) const;
  /// Each place becomes the mean of its own and its neighbours', so many times. @param other  scratch
  void smooth(int rounds, Points& places, Points& other) const;

 private:
  const RegionCells& cells_;
  std::vector<double> nearness_;
  std::vector<Vector2> slope_;
};

}  // namespace lapedit
