// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/linear/accurate_residual.h"
#include "lapedit/linear/sparse_cholesky.h"

namespace lapedit {

/// A0 = M^T M + W0^2, the matrix of the paper's normal equations (section 7), with its Cholesky factor. Immutable, so
/// any number of solvers can share it.
struct FactoredNormalMatrix {
  std::shared_ptr<const OperatorRows> m;
  Eigen::VectorXd squared_weights;  ///< the diagonal of W0^2, n
  double norm = 0;                  ///< largest sum of absolute values in a row of A0
  SparseCholesky cholesky;          ///< each solver solves with a copy of its own

  /// Cost: one sparse Cholesky factorisation. @throws EditError (IllConditioned, BadParameter)
  FactoredNormalMatrix(std::shared_ptr<const OperatorRows> op, Eigen::VectorXd weights, const CholeskyOptions& options);
};

/// Constraint rows h that are not part of the factor of A0, with Z = A0^-1 E and K = (W^-2 + E^T Z)^-1, E their columns
/// of the identity. For a right-hand side that is b_h at these rows, and y = A0^-1 of what it is elsewhere, y + Z K
/// (W^-2 b_h - y_h) solves (A0 + E W^2 E^T) x = b (Woodbury). Targets at the rows enter the correction directly, since
/// solving for them without the rows would give large numbers that cancel. Empty without rows.
struct WoodburyCorrection {
  std::vector<int> rows;
  std::vector<double> weights;  ///< w^2 of each
  Eigen::MatrixXd z;            ///< n x rows
  Eigen::MatrixXd k;            ///< rows x rows
};

/// Solves A x = b, A = A0 + E W^2 E^T, by iterative refinement with the factor of A0 and the correction. The residual
/// is computed through M, as b - M^T (M x) - W^2 x, and not through M^T M, so that a step also corrects the squaring of
/// the condition number.
///
/// Matrix and correction are only read and each solver has scratch of its own, so solvers that share them can work
/// concurrently, each with its own pool. One call at a time per solver. Source: N. Higham, Accuracy and Stability of
/// Numerical Algorithms, chapter 12.
class RefinedSolver {
 public:
  /// @param correction  null: A is A0
  RefinedSolver(std::shared_ptr<const FactoredNormalMatrix> matrix,
                std::shared_ptr<const WoodburyCorrection> correction, std::shared_ptr<ThreadPool> pool);

  /// Solves A0 x = b until a step changes less than `accurate` of the solution, or to double precision. @return the
  /// number of steps; -1 if it does not converge
  int refine_to(const Points& right, Points& x, double accurate);

  /// x = A^-1 right in one solve, to the precision of the factor. @param right used as scratch. Allocates nothing after
  /// the first call.
  void solve(Points& right, Points& x);

  /// Returns an upper bound of the smallest eigenvalue of A0, by a few inverse iterations. Cost: six solves.
  double smallest_eigenvalue();

  /// Solves A x = b to the last bit of a double, whatever the quality of the factor. Allocates nothing after the first
  /// call.
  /// @param progress  called at each step. @throws EditError (Cancelled)
  Refinement refine_to_the_bit(const Points& right, Points& x, const Progress& progress = {});

  /// Returns |A x - b| over (|A0| + largest w^2) |x| + |b|, maximum norms; 0 if all are 0.
  double relative_residual(const Points& right, const Points& x) const;

  SparseCholesky& cholesky() { return cholesky_; }  ///< of A0

 private:
  class System;

  std::shared_ptr<const FactoredNormalMatrix> matrix_;
  std::shared_ptr<const WoodburyCorrection> correction_;
  std::shared_ptr<ThreadPool> pool_;
  SparseCholesky cholesky_;
  Eigen::VectorXd squared_weights_;  // of A

  // Scratch of refine_to_the_bit().
  Points residual_, step_;
  Points at_rows_, corrected_;
  DoubledPoints doubled_, between_;
};

/// Computes the correction for rows that have no weight in A0.
/// @param a0  a solver without a correction
/// @return    null if a column of Z does not reach `accurate` in `most_steps` steps
/// Cost: a refined solution per three rows.
std::optional<WoodburyCorrection> woodbury_correction(RefinedSolver& a0, Eigen::Index size, std::vector<int> rows,
                                                      std::vector<double> squared_weights, double accurate,
                                                      int most_steps);

}  // namespace lapedit
