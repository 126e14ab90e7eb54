// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/matrix_averages.h"
#include "lapedit/linear/operator_rows.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Factor of the extrapolation: each pass fits its rotations to x + kMomentum (x - x_previous), which saves more than
/// half of the passes.
constexpr double kMomentum = 0.9;

/// Fits the rotations of vertices to a pose of a region: R_i is the rotation nearest to the covariance C_i = sum_j
/// alpha_ij (x_i - x_j)(p_i - p_j)^T of the one-ring, averaged eight times over the direct neighbours. This is the
/// local step of as-rigid-as-possible deformation (O. Sorkine, M. Alexa, SGP 2007) with averages, which keep details
/// from tilting.
class RingRotations {
 public:
  /// @param m  differential operator, whose rows hold -alpha_ij; region, m and pool must outlive the object
  RingRotations(const Region& region, const OperatorRows& m, ThreadPool& pool);

  /// @param before        p, size() x 3
  /// @param displacement  x - p
  /// @param rotations     out: one per vertex, exactly the identity where no vertex nearby moves
  /// Cost: O(edges). The bits are the same for any number of threads; nothing is allocated after the first call.
  void fit(const Points& before, const Points& displacement, std::vector<Matrix3>& rotations);

 private:
  const Region& region_;
  const OperatorRows& m_;
  ThreadPool& pool_;
  MatrixAverages covariances_;  // only takes memory once it is used
};

}  // namespace lapedit
