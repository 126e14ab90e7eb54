// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCholesky>

#include "lapedit/base/types.h"

namespace lapedit {

/// Eigen's factorisation L D L^T of a symmetric positive definite matrix with a row for each cell.
class SmallCholesky {
 public:
  /// @param matrix  only its lower half is read
  /// @throws EditError (IllConditioned) if it is not positive definite to working precision
  explicit SmallCholesky(const SparseMatrix& matrix);

  /// Solves for three right-hand sides: x = matrix^-1 right. Both may be the same object. Allocates nothing after the
  /// first call.
  void solve(const Points& right, Points& x);

 private:
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> factor_;
  Eigen::VectorXd pivots_;                                          // D
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> rows_;  // scratch, in the order of elimination
};

}  // namespace lapedit
