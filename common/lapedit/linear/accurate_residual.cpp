// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/accurate_residual.h"

#include <cstddef>

#include "lapedit/base/cpu_dispatch.h"

// This file must be compiled without contraction of a * b + c: the errors of products and sums would be wrong.

namespace lapedit {
namespace {

constexpr int kGrain = 1024;
constexpr int kLanes = 4;  // three coordinates, and one to fill the vector

/// The error a b - p of the rounded product p: exact, with an instruction for it (Fused) or by splitting factors into
/// halves of 26 bits (TwoProduct, Dekker 1971; Ogita, Rump, Oishi 2005, section 2).
struct Fused {
  static LAPEDIT_INLINE double error(double a, double b, double p) { return __builtin_fma(a, b, -p); }
};
struct Split {
  static LAPEDIT_INLINE double error(double a, double b, double p) {
    constexpr double kHalf = 134217729;  // 2^27 + 1
    const double ca = kHalf * a, cb = kHalf * b;
    const double ah = ca - (ca - a), al = a - ah, bh = cb - (cb - b), bl = b - bh;
    return al * bl - (((p - ah * bh) - al * bh) - ah * bl);
  }
};

/// high + low, and what is added to them: the error of high + term is exact (TwoSum, Knuth 1969), and goes into low
/// with that of the product (Dot2, Ogita, Rump, Oishi 2005, section 4).
struct Sum {
  double high[kLanes] = {}, low[kLanes] = {};

  LAPEDIT_INLINE void add(int lane, double term, double error) {
    const double sum = high[lane] + term;
    const double part = sum - high[lane];
    low[lane] += ((high[lane] - (sum - part)) + (term - part)) + error;
    high[lane] = sum;
  }
  template <class Product>
  LAPEDIT_INLINE void add_product(double factor, const double* x_high, const double* x_low) {
    for (int lane = 0; lane < 3; ++lane) {
      const double term = factor * x_high[lane];
      add(lane, term, Product::error(factor, x_high[lane], term) + factor * x_low[lane]);
    }
  }
};

/// One pass over a range of rows: sums of entries times rows of x; then, where there is a right-hand side, what is left
/// of it.
struct Pass {
  const int* offsets;
  const int* inner;
  const double* values;
  const double *x_high, *x_low;  // what the entries are multiplied with

  // Without a right-hand side the sums themselves.
  double *sum_high, *sum_low;

  const double* right;
  double* left;
  const double* diagonal;        // may be null
  const double *d_high, *d_low;  // what it is multiplied with
};

template <class Product>
LAPEDIT_INLINE void run(const Pass& pass, int first, int last) {
  for (int i = first; i < last; ++i) {
    const auto row = 3 * static_cast<std::size_t>(i);
    Sum sum;
    for (int k = pass.offsets[i]; k < pass.offsets[i + 1]; ++k) {
      const auto from = 3 * static_cast<std::size_t>(pass.inner[k]);
      sum.add_product<Product>(pass.values[k], pass.x_high + from, pass.x_low + from);
    }
    if (pass.right == nullptr) {
      for (int lane = 0; lane < 3; ++lane) {
        const double high = sum.high[lane] + sum.low[lane];
        pass.sum_low[row + lane] = sum.low[lane] - (high - sum.high[lane]);
        pass.sum_high[row + lane] = high;
      }
      continue;
    }
    if (pass.diagonal != nullptr) {
      sum.add_product<Product>(pass.diagonal[i], pass.d_high + row, pass.d_low + row);
    }
    for (int lane = 0; lane < 3; ++lane) {
      sum.add(lane, -pass.right[row + lane], 0);
      pass.left[row + lane] = -(sum.high[lane] + sum.low[lane]);
    }
  }
}

void run_plain(const Pass& pass, int first, int last) {
  run<Split>(pass, first, last);
}
#ifdef LAPEDIT_HAVE_AVX
LAPEDIT_AVX2 void run_fused(const Pass& pass, int first, int last) {
  run<Fused>(pass, first, last);
}
#endif

using Run = void (*)(const Pass&, int, int);

Run best_run() {
#ifdef LAPEDIT_HAVE_AVX
  if (cpu_level() != CpuLevel::Plain) {
    return run_fused;
  }
#endif
  return run_plain;
}

template <class Compressed>
Pass pass_over(const Compressed& lists, const DoubledPoints& x) {
  Pass pass = {};
  pass.offsets = lists.outerIndexPtr();
  pass.inner = lists.innerIndexPtr();
  pass.values = lists.valuePtr();
  pass.x_high = x.high.data();
  pass.x_low = x.low.data();
  return pass;
}

}  // namespace

void DoubledPoints::set(const Points& points) {
  high = points;
  low.setZero(points.rows(), 3);
}

/// high + low + step, normalised so that low is at most half a unit in the last place of high.
void DoubledPoints::add(const Points& step) {
  for (Eigen::Index i = 0; i < high.size(); ++i) {
    double& a = high.data()[i];
    double& b = low.data()[i];
    const double term = step.data()[i];
    const double sum = a + term;
    const double part = sum - a;
    const double error = ((a - (sum - part)) + (term - part)) + b;
    a = sum + error;
    b = error - (a - sum);
  }
}

void normal_residual(const OperatorRows& m, const Eigen::VectorXd& diagonal, const Points& right,
                     const DoubledPoints& x, DoubledPoints& between, Points& out, ThreadPool& pool) {
  const Run run = best_run();
  const int n = static_cast<int>(right.rows());
  between.high.resize(n, 3);
  between.low.resize(n, 3);
  out.resize(n, 3);
  Pass forward = pass_over(m.rows(), x);
  forward.sum_high = between.high.data();
  forward.sum_low = between.low.data();
  in_pieces(pool, n, kGrain, [&](int first, int last) { run(forward, first, last); });
  Pass back = pass_over(m.matrix(), between);
  back.right = right.data();
  back.left = out.data();
  back.diagonal = diagonal.data();
  back.d_high = x.high.data();
  back.d_low = x.low.data();
  in_pieces(pool, n, kGrain, [&](int first, int last) { run(back, first, last); });
}

void symmetric_residual(const SparseMatrix& a, const Points& right, const DoubledPoints& x, Points& out) {
  out.resize(right.rows(), 3);
  Pass pass = pass_over(a, x);
  pass.right = right.data();
  pass.left = out.data();
  best_run()(pass, 0, static_cast<int>(right.rows()));
}

}  // namespace lapedit
