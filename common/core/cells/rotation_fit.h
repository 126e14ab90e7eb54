// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/cells/region_cells.h"
#include "lapedit/cells/small_cholesky.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// A pose of the vertices extrapolated from the last two, which saves more than half of the passes. Empty before the
/// first.
struct Extrapolation {
  Points previous, ahead;  ///< size() x 3: displacement of the last pass, and the extrapolated one

  /// @param pass  number of poses before this one
  const Points& operator()(const Points& displacement, int pass) {
    constexpr double kMomentum = 0.9;
    ahead = displacement;
    if (pass > 0) {
      ahead += kMomentum * (displacement - previous);
    }
    previous = displacement;
    return ahead;
  }
};

/// Fits rotations of cells to a pose of the vertices: the local step of as-rigid-as-possible deformation (O. Sorkine,
/// M. Alexa, SGP 2007). The covariance of a cell is the sum of w_ij (x_i - x_j)(p_i - p_j)^T over its vertices i.
/// Covariances are smoothed along the surface, so that details do not tilt, by the same length however fine the mesh
/// is: (A + T L)^-1 A (A + T L)^-1 sum, with T chosen so that the variance along one direction is 1/160 of the area
/// that is free to move, and at most 0.3 of the squared radius of curvature. R is the rotation nearest to the result.
class RotationFit {
 public:
  /// @param cells  must outlive the object
  explicit RotationFit(const RegionCells& cells);

  /// @param before        p, size() x 3
  /// @param displacement  x - p
  /// @return one rotation per cell, valid until the next call; exactly the identity in components that do not move
  /// Cost: O(edges). The bits are the same for any number of threads; nothing is allocated.
  const std::vector<Matrix3>& operator()(const LaplacianSystem& system, const Points& before,
                                         const Points& displacement);

 private:
  void diffuse(Points& rows);

  const RegionCells& cells_;
  CompressedRows members_;  // vertices of each cell
  Eigen::VectorXd areas_;
  std::unique_ptr<SmallCholesky> diffusion_;
  Points rest_[3], moved_[3], scratch_;  // rows of a matrix per cell
  std::vector<Matrix3> rotations_;
};

}  // namespace lapedit
