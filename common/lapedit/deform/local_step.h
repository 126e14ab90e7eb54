// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/laplacian_system.h"
#include "lapedit/deform/matrix_averages.h"

namespace lapedit {

/// How a local step fits rotations to a pose.
struct FitSettings {
  /// Factor of the extrapolation: rotations are fitted to x + momentum (x - x_previous).
  double momentum;
  /// Number of averagings of the covariances over direct neighbours.
  int averagings;
};

/// Over vertices. The momentum saves more than half of the passes. With fewer averagings details tilt more: by 14.6 and
/// 25.8 degrees with 2, by 11.5 and 19.7 with 8 (detail_orientation_test).
constexpr FitSettings kVertexFit = {0.9, 8};
/// Over cells, which are several rings wide. Found by measuring stretch, folds and the tilt of details over some twenty
/// edits (tests/scripts/quality.sh).
constexpr FitSettings kCellFit = {0.5, 1};

/// Scratch memory of local_step(). Empty before the first call.
struct LocalStepScratch {
  Points previous, ahead;  ///< size() x 3: displacement of the last pass, and the extrapolated one
  MatrixAverages covariances;
};

/// Fits rotations to a pose of a region's vertices, the local step of as-rigid-as-possible deformation (O. Sorkine, M.
/// Alexa, SGP 2007) with averages, which keep details from tilting: R_i is the rotation nearest to the covariance C_i =
/// sum_j alpha_ij (x_i - x_j)(p_i - p_j)^T of the one-ring, averaged over neighbours as kVertexFit says.
/// @param before        p, size() x 3
/// @param displacement  x - p, extrapolated if this is not the first pass
/// @param pass          number of local steps of this pose before this one
/// @param rotations     out: one per vertex, exactly the identity where no vertex nearby moves
/// Cost: O(edges). The bits are the same for any number of threads; nothing is allocated after the first calls.
void local_step(const LaplacianSystem& system, const Points& before, const Points& displacement, int pass,
                LocalStepScratch& scratch, std::vector<Matrix3>& rotations);

}  // namespace lapedit
