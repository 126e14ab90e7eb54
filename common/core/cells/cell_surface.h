// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/cells/region_cells.h"

namespace lapedit {

/// The cells of a region as a surface: weights of neighbours, normals, smoothing.
class CellSurface {
 public:
  /// @param cells  must outlive the object
  explicit CellSurface(const RegionCells& cells);

  /// The weight of an entry of cells.neighbours in averages over a cell's surroundings.
  double nearness(int entry) const { return nearness_[entry]; }
  /// The contribution of a neighbour's displacement to the gradient along the surface, in a basis of the cell's tangent
  /// plane.
  const Vector2& slope(int entry) const { return slope_[entry]; }
  /// Returns the unit normal at a cell for the given positions of all cells; zero if it is undefined.
  Vector3 normal(int cell, const Points& at) const;
  /// Replaces each position by the mean of its own and its neighbours' positions, `rounds` times.
  /// @param other  scratch
  void smooth(int rounds, Points& positions, Points& other) const;

 private:
  const RegionCells& cells_;
  std::vector<double> nearness_;
  std::vector<Vector2> slope_;
};

}  // namespace lapedit
