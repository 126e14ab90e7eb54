// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/linear/linear.h"

namespace lapedit {
namespace {

/// Computes out = M^T (M x) + W^2 x. @param between scratch
void normal_product(const OperatorRows& m, const Eigen::VectorXd& squared_weights, const Points& x, Points& between,
                    Points& out, ThreadPool& pool) {
  m.apply(x, between, pool);
  m.apply_left_factor(between, out, pool);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    out.row(i) += squared_weights[i] * x.row(i);
  }
}

/// Calls use(j, m_vj) for the entries of a row of M.
template <class Use>
void each_entry(const OperatorRows& m, int row, const Use& use) {
  for (OperatorRows::Rows::InnerIterator entry(m.rows(), row); entry; ++entry) {
    use(entry.col(), entry.value());
  }
}

/// Computes row c of E^T x, see WoodburyCorrection.
template <class X, class Row>
void take_row(const FactoredNormalMatrix& matrix, const std::vector<int>& rows, std::size_t c, const X& x, Row&& out) {
  if (c < rows.size()) {
    out = x.row(rows[c]);
  } else {
    out.setZero();
    each_entry(*matrix.m, matrix.long_rows[c - rows.size()],
               [&](Eigen::Index j, double value) { out += value * x.row(j); });
  }
}

}  // namespace

FactoredNormalMatrix::FactoredNormalMatrix(std::shared_ptr<const OperatorRows> op, Eigen::VectorXd weights,
                                           const CholeskyOptions& options)
    : m(std::move(op)),
      long_rows(m->long_rows()),
      squared_weights(std::move(weights)),
      cholesky(m->normal_matrix(squared_weights, *options.pool, long_rows), options) {}

RefinedSolver::RefinedSolver(std::shared_ptr<const FactoredNormalMatrix> matrix,
                             std::shared_ptr<const WoodburyCorrection> correction, std::shared_ptr<ThreadPool> pool)
    : matrix_(std::move(matrix)),
      correction_(correction ? std::move(correction) : std::make_shared<const WoodburyCorrection>()),
      pool_(std::move(pool)),
      cholesky_(matrix_->cholesky, pool_),
      at_rows_(correction_->k.rows(), 3) {}

int RefinedSolver::refine_to(const Points& right, Points& x, double accurate) {
  // A factor in single precision that converges more slowly than kSlow is rejected; one in double precision is the last
  // resort. The first step says little: on 3,000,000 vertices the second change was a tenth of the first, the third
  // 1e-5.
  constexpr double kSlow = 0.25, kStalled = 0.1, kGoodEnough = 1e-10;
  const double hopeless = cholesky_.single_precision() ? kSlow : 0.5;
  const int most_steps = cholesky_.single_precision() ? 8 : 40;
  Points between, residual, step;
  cholesky_.solve(right, x);
  double last = 1;
  for (int count = 0;; ++count) {
    normal_product(*matrix_->m, matrix_->squared_weights, x, between, residual, *pool_);
    for (const int row : matrix_->long_rows) {
      each_entry(*matrix_->m, row, [&](Eigen::Index j, double value) { residual.row(j) -= value * between.row(row); });
    }
    residual = right - residual;
    cholesky_.solve(residual, step);
    const double change = largest_row(step) / largest_row(x);
    if (!(change > accurate) || (last < kGoodEnough && !(change < kStalled * last))) {
      return std::isfinite(change) ? count : -1;
    }
    if (!(change < hopeless * last) || count == most_steps) {
      return -1;
    }
    x += step;
    if (change * change / last < accurate) {
      return count + 1;  // the next change would be below `accurate`
    }
    last = change;
  }
}

/// Computes x = A^-1 b to the precision of the factor A0 by the Woodbury formula: x = y + Z K (W^-2 b_h - E^T y), where
/// b_h is 0 for long rows. Here y solves A0 y = b without b_h, the rows of b whose constraints the factor omits.
void RefinedSolver::solve(Points& right, Points& x) {
  const WoodburyCorrection& add = *correction_;
  Points &at_rows = at_rows_, &corrected = corrected_;
  if (add.z.cols() == 0) {
    cholesky_.solve(right, x);
    return;
  }
  for (std::size_t c = 0; c < add.rows.size(); ++c) {
    at_rows.row(static_cast<Eigen::Index>(c)) = right.row(add.rows[c]);
    right.row(add.rows[c]).setZero();
  }
  cholesky_.solve(right, x);
  for (std::size_t c = 0; c < add.rows.size(); ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    right.row(add.rows[c]) = at_rows.row(row);
    at_rows.row(row) = at_rows.row(row) / add.weights[c] - x.row(add.rows[c]);
  }
  for (auto c = static_cast<Eigen::Index>(add.rows.size()); c < at_rows.rows(); ++c) {
    take_row(*matrix_, add.rows, static_cast<std::size_t>(c), x, at_rows.row(c));
    at_rows.row(c) *= -1;
  }
  corrected = add.k.lazyProduct(at_rows);
  constexpr int kGrain = 4096;
  in_pieces(*pool_, static_cast<int>(x.rows()), kGrain, [&](int first, int last) {
    for (Eigen::Index c = 0; c < corrected.rows(); ++c) {
      for (int i = first; i < last; ++i) {
        x.row(i) += add.z(i, c) * corrected.row(c);
      }
    }
  });
}

std::optional<WoodburyCorrection> woodbury_correction(RefinedSolver& a0, Eigen::Index size, std::vector<int> rows,
                                                      std::vector<double> squared_weights, double accurate,
                                                      int most_steps) {
  const FactoredNormalMatrix& matrix = a0.matrix();
  const std::size_t given = rows.size();
  const auto count = static_cast<Eigen::Index>(given + matrix.long_rows.size());
  WoodburyCorrection made;
  made.rows = std::move(rows);
  made.weights = std::move(squared_weights);
  // Z = A0^-1 E
  made.z.resize(size, count);
  Points right, found;
  for (Eigen::Index first = 0; first < count; first += 3) {
    const Eigen::Index columns = std::min<Eigen::Index>(3, count - first);
    right.setZero(size, 3);
    for (Eigen::Index c = 0; c < columns; ++c) {
      if (const auto at = static_cast<std::size_t>(first + c); at < given) {
        right(made.rows[at], c) = 1;
      } else {
        each_entry(*matrix.m, matrix.long_rows[at - given], [&](Eigen::Index j, double value) { right(j, c) = value; });
      }
    }
    const int steps = a0.refine_to(right, found, accurate);
    if (steps < 0 || steps > most_steps) {
      return std::nullopt;
    }
    made.z.middleCols(first, columns) = found.leftCols(columns);
  }
  // K = (W^-2 + E^T Z)^-1
  Eigen::MatrixXd small(count, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const auto at = static_cast<std::size_t>(c);
    take_row(matrix, made.rows, at, made.z, small.row(c));
    small(c, c) += at < given ? 1 / made.weights[at] : 1;
  }
  made.k = small.llt().solve(Eigen::MatrixXd::Identity(count, count));
  return made;
}

}  // namespace lapedit
