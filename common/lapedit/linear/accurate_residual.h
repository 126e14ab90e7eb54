// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/linear/linear.h"

namespace lapedit {

/// Residuals of linear systems in about twice the working precision. With them iterative refinement makes the solution
/// correct to the last bit of a double, whatever the quality of the factor: results do not depend on ordering or
/// processor. Source: T. Ogita, S. Rump, S. Oishi, Accurate sum and dot product, SISC 2005.

/// Points of twice the working precision: each coordinate is the sum of two numbers, low at most half a unit in the
/// last place of high.
struct DoubledPoints {
  Points high, low;

  void set(const Points& points);
  void add(const Points& step, ThreadPool& pool);
};

/// Computes out = right - (M^T M + diag(diagonal)) x, with an error of about 1e-31 of the terms' sizes plus the final
/// rounding.
/// @param between  scratch; it and `out` keep their storage if they have the right size
/// Cost: O(entries of M).
void normal_residual(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& right,
                     const DoubledPoints& x, DoubledPoints& between, Points& out, ThreadPool& pool);

/// Computes out = right - A x with the same accuracy, for a symmetric matrix with both halves stored.
void symmetric_residual(const SparseMatrix& a, const Points& right, const DoubledPoints& x, Points& out,
                        ThreadPool& pool);

/// Updates a residual after a small step, for a fifth of the cost of a new one: left -= (M^T M + diag(diagonal)) step,
/// in working precision. @param between  scratch
void subtract_normal_product(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& step,
                             Points& between, Points& left, ThreadPool& pool);

/// Updates a residual by left -= A step, for a symmetric matrix with both halves stored.
void subtract_symmetric_product(const SparseMatrix& a, const Points& step, Points& left, ThreadPool& pool);

/// The operations that iterative refinement needs from a system A x = b and a factor of A.
class RefinedSystem {
 public:
  virtual ~RefinedSystem() = default;
  /// left = b - A x in doubled precision.
  virtual void residual(const DoubledPoints& x, Points& left) = 0;
  /// left -= A step in working precision; called only if the factor is in single precision.
  virtual void subtract_product(const Points& step, Points& left) = 0;
  /// step = A^-1 left approximately. May use left as scratch.
  virtual void solve(Points& left, Points& step) = 0;
};

/// Refines a solution until it is correct to the last bit, or until steps stop improving it. Residuals are computed in
/// doubled precision only where working precision would spoil the next step. The steps end when another one, at the
/// rate of the slowest so far, would change nothing.
/// @param single_precision  whether the factor is in single precision
/// @param left   the right-hand side; scratch. @param x  out: the solution. @param step  scratch
Refinement refine_to_the_bit(RefinedSystem& system, bool single_precision, DoubledPoints& x, Points& left, Points& step,
                             ThreadPool& pool);

}  // namespace lapedit
