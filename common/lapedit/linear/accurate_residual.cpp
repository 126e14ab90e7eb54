// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/accurate_residual.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "lapedit/base/simd.h"

// The compiler must not contract a * b + c in this file, since contraction makes the computed rounding errors wrong.

namespace lapedit {
namespace {

constexpr int kGrain = 1024;

/// Three coordinates, and one to fill the vector register.
using Lanes = Doubles4;

/// Returns the exact error a b - p of the rounded product p, by a fused instruction (Fused) or by splitting factors
/// into halves of 26 bits (TwoProduct, Dekker 1971; Ogita, Rump, Oishi 2005, section 2).
struct Fused {
  static LAPEDIT_INLINE Lanes error(double a, Lanes b, Lanes p) {
    Lanes result;
    for (int lane = 0; lane < 4; ++lane) {
      result[lane] = fused(a, b[lane], -p[lane]);
    }
    return result;
  }
};
struct Split {
  static LAPEDIT_INLINE Lanes error(double a, Lanes b, Lanes p) {
    constexpr double kHalf = 134217729;  // 2^27 + 1
    const double ca = kHalf * a, ah = ca - (ca - a), al = a - ah;
    const Lanes cb = kHalf * b, bh = cb - (cb - b), bl = b - bh;
    return al * bl - (((p - ah * bh) - al * bh) - ah * bl);
  }
};

/// Reads row i of n x 3 points. One load reads four numbers if a row follows. With kAlone as the last row, it reads
/// only the row: for rows that the same pass writes, since another thread may be writing the next row.
constexpr int kAlone = -1;
LAPEDIT_INLINE Lanes row_of(const double* points, int i, int last_row) {
  Lanes row = {};
  const double* const from = points + 3 * static_cast<std::size_t>(i);
  if (i < last_row) {
    std::memcpy(&row, from, sizeof row);
  } else {
    std::memcpy(&row, from, 3 * sizeof(double));
  }
  return row;
}

LAPEDIT_INLINE void set_row(double* points, int i, Lanes row) {
  std::memcpy(points + 3 * static_cast<std::size_t>(i), &row, 3 * sizeof(double));
}

/// A sum high + low. add() computes the error of high + term exactly (TwoSum, Knuth 1969) and adds it to low, with the
/// error of the product (Dot2, Ogita, Rump, Oishi 2005, section 4).
struct Sum {
  Lanes high = {}, low = {};

  LAPEDIT_INLINE void add(Lanes term, Lanes error) {
    const Lanes sum = high + term;
    const Lanes added = sum - high;
    low += ((high - (sum - added)) + (term - added)) + error;
    high = sum;
  }
  template <class Product>
  LAPEDIT_INLINE void add_product(double factor, Lanes x_high, Lanes x_low) {
    const Lanes term = factor * x_high;
    add(term, Product::error(factor, x_high, term) + factor * x_low);
  }
};

/// One pass over a range of rows: sums of entries times rows of x, subtracted from the right-hand side if there is one.
struct Pass {
  int rows;
  const int* offsets;
  const int* inner;
  const double* values;
  int last_row;                  // last row of the factors
  const double *x_high, *x_low;  // factors of the entries; x_low null: all in working precision

  // Output if there is no right-hand side: the sums.
  double *sum_high, *sum_low;

  const double* right;
  double* left;
  const double* diagonal;        // may be null
  const double *d_high, *d_low;  // its factors
};

/// Runs a pass in working precision.
LAPEDIT_INLINE void run_coarse(const Pass& pass, int first, int last) {
  for (int i = first; i < last; ++i) {
    Lanes sum = {};
    for (int k = pass.offsets[i]; k < pass.offsets[i + 1]; ++k) {
      sum += pass.values[k] * row_of(pass.x_high, pass.inner[k], pass.last_row);
    }
    if (pass.right == nullptr) {
      set_row(pass.sum_high, i, sum);
    } else {
      if (pass.diagonal != nullptr) {
        sum += pass.diagonal[i] * row_of(pass.d_high, i, pass.rows - 1);
      }
      set_row(pass.left, i, row_of(pass.right, i, kAlone) - sum);
    }
  }
}

template <class Product>
LAPEDIT_INLINE void run(const Pass& pass, int first, int last) {
  if (pass.x_low == nullptr) {
    return run_coarse(pass, first, last);
  }
  for (int i = first; i < last; ++i) {
    Sum sum;
    for (int k = pass.offsets[i]; k < pass.offsets[i + 1]; ++k) {
      const int j = pass.inner[k];
      sum.add_product<Product>(pass.values[k], row_of(pass.x_high, j, pass.last_row),
                               row_of(pass.x_low, j, pass.last_row));
    }
    if (pass.right == nullptr) {
      const Lanes high = sum.high + sum.low;
      set_row(pass.sum_low, i, sum.low - (high - sum.high));
      set_row(pass.sum_high, i, high);
      continue;
    }
    if (pass.diagonal != nullptr) {
      sum.add_product<Product>(pass.diagonal[i], row_of(pass.d_high, i, pass.rows - 1),
                               row_of(pass.d_low, i, pass.rows - 1));
    }
    sum.add(-row_of(pass.right, i, kAlone), Lanes{});
    set_row(pass.left, i, -(sum.high + sum.low));
  }
}

void run_plain(const Pass& pass, int first, int last) {
  run<Split>(pass, first, last);
}
LAPEDIT_AVX2 void run_fused(const Pass& pass, int first, int last) {
  run<Fused>(pass, first, last);
}

void run_all(const Pass& pass, ThreadPool& pool) {
  const auto run = for_processor(run_plain, run_fused, run_fused);
  in_pieces(pool, pass.rows, kGrain, [&](int first, int last) { run(pass, first, last); });
}

/// @param low  may be null
template <class Compressed>
Pass pass_over(const Compressed& lists, const Points& high, const Points* low) {
  Pass pass = {};
  pass.rows = static_cast<int>(lists.outerSize());
  pass.offsets = lists.outerIndexPtr();
  pass.inner = lists.innerIndexPtr();
  pass.values = lists.valuePtr();
  pass.last_row = static_cast<int>(high.rows()) - 1;
  pass.x_high = high.data();
  pass.x_low = low != nullptr ? low->data() : nullptr;
  return pass;
}

double largest(const Points& points, ThreadPool& pool) {
  constexpr int kPieces = 16;
  const Eigen::Index n = points.rows();
  const int pieces = n >= static_cast<Eigen::Index>(kPieces) * kGrain ? kPieces : 1;
  double most[kPieces] = {};
  pool.each(n > 0 ? pieces : 0, [&](int piece) {
    const Eigen::Index first = n * piece / pieces;
    most[piece] = points.middleRows(first, n * (piece + 1) / pieces - first).cwiseAbs().maxCoeff();
  });
  double all = 0;
  for (const double one : most) {
    all = one > all || std::isnan(one) ? one : all;
  }
  return all;
}

}  // namespace

void DoubledPoints::set(const Points& points) {
  high = points;
  low.setZero(points.rows(), 3);
}

/// Computes high + low + step, normalised so that |low| is at most half a unit in the last place of high.
void DoubledPoints::add(const Points& step, ThreadPool& pool) {
  in_pieces(pool, static_cast<int>(high.rows()), kGrain, [&](int first, int last) {
    for (Eigen::Index i = 3 * static_cast<Eigen::Index>(first); i < 3 * static_cast<Eigen::Index>(last); ++i) {
      double& a = high.data()[i];
      double& b = low.data()[i];
      const double term = step.data()[i];
      const double sum = a + term;
      const double added = sum - a;
      const double error = ((a - (sum - added)) + (term - added)) + b;
      a = sum + error;
      b = error - (a - sum);
    }
  });
}

void normal_residual(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& right,
                     const DoubledPoints& x, DoubledPoints& between, Points& out, ThreadPool& pool) {
  between.high.resize(m.rows().rows(), 3);
  between.low.resize(m.rows().rows(), 3);
  out.resize(right.rows(), 3);
  Pass forward = pass_over(m.rows(), x.high, &x.low);
  forward.sum_high = between.high.data();
  forward.sum_low = between.low.data();
  run_all(forward, pool);
  Pass back = pass_over(m.matrix(), between.high, &between.low);
  back.right = right.data();
  back.left = out.data();
  back.diagonal = diagonal.data();
  back.d_high = x.high.data();
  back.d_low = x.low.data();
  run_all(back, pool);
}

void symmetric_residual(const SparseMatrix& a, const Points& right, const DoubledPoints& x, Points& out,
                        ThreadPool& pool) {
  out.resize(right.rows(), 3);
  Pass pass = pass_over(a, x.high, &x.low);
  pass.right = right.data();
  pass.left = out.data();
  run_all(pass, pool);
}

void subtract_normal_product(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& step,
                             Points& between, Points& left, ThreadPool& pool) {
  between.resize(m.rows().rows(), 3);
  Pass forward = pass_over(m.rows(), step, nullptr);
  forward.sum_high = between.data();
  run_all(forward, pool);
  Pass back = pass_over(m.matrix(), between, nullptr);
  back.right = left.data();
  back.left = left.data();
  back.diagonal = diagonal.data();
  back.d_high = step.data();
  run_all(back, pool);
}

void subtract_symmetric_product(const SparseMatrix& a, const Points& step, Points& left, ThreadPool& pool) {
  Pass pass = pass_over(a, step, nullptr);
  pass.right = left.data();
  pass.left = left.data();
  run_all(pass, pool);
}

Refinement refine_to_the_bit(RefinedSystem& system, bool single_precision, DoubledPoints& x, Points& left, Points& step,
                             ThreadPool& pool) {
  constexpr double kAccurate = 1e-28, kStalled = 0.5, kSpoiled = 0.1;
  constexpr int kMostSteps = 90;
  // The error after a solve comes from the factor's rounding and grows with the condition number; so does the error of
  // a residual in working precision, which is about 2^-29 of it.
  const double coarse = single_precision ? 16 * 0x1p-29 : 1;
  double rate =
      single_precision ? 1e-5 : 1e-12;  // fraction of an error that a step leaves: the worst so far, or a guess
  double moved = 0;                     // sum of steps that were subtracted in working precision
  bool started = false, exact = true;
  Refinement done;
  done.last_change = 1;
  while (done.steps < kMostSteps) {
    const double most = largest(left, pool);
    if (!(most > 0) || !std::isfinite(most)) {
      if (!started) {
        x.set(left);
      }
      done.last_change = most;
      break;
    }
    system.solve(left, step);
    double change = 1;
    if (!started) {
      x.set(step);
      started = true;
    } else {
      const double size = largest(x.high, pool);
      change = size > 0 ? largest(step, pool) / size : 1;
      if (!(change < kStalled * done.last_change)) {
        if (exact) {
          break;
        }
        system.residual(x, left);
        ++done.steps;
        moved = 0;
        exact = true;
        continue;
      }
      x.add(step, pool);
      rate = std::max(rate, change / done.last_change);
      done.last_change = change;
      if (rate * change < kAccurate && coarse * rate * moved < kAccurate) {
        break;
      }
    }
    ++done.steps;
    exact = !(coarse * rate * (moved + change) < std::max(kSpoiled * rate * change, kAccurate));
    if (exact) {
      system.residual(x, left);
      moved = 0;
    } else {
      system.subtract_product(step, left);
      moved += change;
    }
  }
  return done;
}

}  // namespace lapedit
