// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

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
  void add(const Points& step);
};

/// out = right - (M^T M + diag(diagonal)) x. Relative error about 1e-31 of the sizes of the terms, but for the last
/// rounding. @param between  scratch; it and out keep their storage if they have the right size. O(entries of M)
void normal_residual(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& right,
                     const DoubledPoints& x, DoubledPoints& between, Points& out, ThreadPool& pool);

/// out = right - A x, for a symmetric matrix with both halves stored; likewise.
void symmetric_residual(const SparseMatrix& a, const Points& right, const DoubledPoints& x, Points& out);

/// Iterative refinement of a solution until it is right to the last bit, or until a step does not get it much nearer
/// any more.
/// @param residual  called as residual(x, out): out = what is left of the right-hand side after A x
/// @param solve     called as solve(right, out): out about A^-1 right; may change right
/// @param x         in: a solution with a few good digits; out: better
/// @param left,step  scratch
/// @return the size of the last step over that of the solution
template <class Residual, class Solve>
double refine_to_the_bit(const Residual& residual, const Solve& solve, DoubledPoints& x, Points& left, Points& step) {
  constexpr double kAccurate = 1e-22, kStalled = 0.5;
  constexpr int kMostSteps = 60;
  double last = 1;
  for (int count = 0; count < kMostSteps; ++count) {
    residual(x, left);
    const double most = left.size() > 0 ? left.cwiseAbs().maxCoeff() : 0;
    if (!(most > 0) || !std::isfinite(most)) {
      return most;
    }
    // Not too small for a solution in single precision. A power of two changes no digits.
    const double scale = std::exp2(-std::ilogb(most));
    left *= scale;
    solve(left, step);
    step /= scale;
    const double size = x.high.cwiseAbs().maxCoeff();
    const double change = size > 0 ? step.cwiseAbs().maxCoeff() / size : 1;
    if (!(change < kStalled * last)) {
      return last;
    }
    x.add(step);
    last = change;
    if (change < kAccurate) {
      break;
    }
  }
  return last;
}

}  // namespace lapedit
