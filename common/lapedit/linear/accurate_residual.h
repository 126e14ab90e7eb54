// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/base/thread_pool.h"
#include "lapedit/linear/operator_rows.h"

namespace lapedit {

/// Residuals of linear systems in about twice the working precision. With them iterative refinement goes on until the
/// solution is right to the last bit of a double, whatever the factorisation is like: results do not depend on the
/// BLAS, the ordering or the processor. Source: T. Ogita, S. Rump, S. Oishi, Accurate sum and dot product, SISC 2005.

/// Points of twice the working precision: the sum of two numbers each, low at most half a unit in the last place of
/// high.
struct DoubledPoints {
  Points high, low;

  void set(const Points& points);
  void add(const Points& step, ThreadPool& pool);
};

/// out = right - (M^T M + diag(diagonal)) x. Relative error about 1e-31 of the sizes of the terms, but for the last
/// rounding. @param between  scratch; it and out keep their storage if they have the right size. O(entries of M)
void normal_residual(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& right,
                     const DoubledPoints& x, DoubledPoints& between, Points& out, ThreadPool& pool);

/// out = right - A x, for a symmetric matrix with both halves stored; likewise.
void symmetric_residual(const SparseMatrix& a, const Points& right, const DoubledPoints& x, Points& out,
                        ThreadPool& pool);

/// left -= (M^T M + diag(diagonal)) step, in working precision: a residual after a small step, for a fifth of the price
/// of a new one. @param between  scratch
void subtract_normal_product(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& step,
                             Points& between, Points& left, ThreadPool& pool);

/// left -= A step for a symmetric matrix with both halves stored, likewise.
void subtract_symmetric_product(const SparseMatrix& a, const Points& step, Points& left, ThreadPool& pool);

/// What iterative refinement asks of a system A x = b and a factor of A.
class RefinedSystem {
 public:
  virtual ~RefinedSystem() = default;
  /// left = b - A x in doubled precision.
  virtual void residual(const DoubledPoints& x, Points& left) = 0;
  /// left -= A step in working precision; asked only where the factor is in single precision.
  virtual void subtract_product(const Points& step, Points& left) = 0;
  /// step about A^-1 left. May change left while it works.
  virtual void solve(Points& left, Points& step) = 0;
};

/// How a refinement went.
struct Refinement {
  int steps = 0;           ///< residuals taken
  double last_change = 0;  ///< the size of the last step over that of the solution

  bool converged() const { return last_change < 1e-6; }  ///< else the solution is not to be trusted
};

/// Iterative refinement of a solution until it is right to the last bit, or until a step does not get it much nearer
/// any more. A residual is taken in doubled precision only where working precision would spoil the next step, and the
/// steps end when one more, at the pace of the slowest so far, would not be seen.
/// @param single_precision  whether the factor is
/// @param left   the right-hand side; scratch. @param x  out: the solution. @param step  scratch
Refinement refine_to_the_bit(RefinedSystem& system, bool single_precision, DoubledPoints& x, Points& left, Points& step,
                             ThreadPool& pool);

}  // namespace lapedit
