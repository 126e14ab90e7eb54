// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>
#include <utility>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/progress.h"
#include "lapedit/linear/linear.h"
#include "lapedit/linear/supernodal_solve.h"

namespace lapedit {

namespace {

/// A block of a half, times an entry of a column of C.
struct Part {
  Eigen::Index column;
  double entry;
  const double* values;
  int size;
};

/// Part of the result: the lower half, of some columns.
struct Product {
  std::vector<Eigen::Index> columns;
  Eigen::MatrixXd values;
};

/// Multiplies the parts of one block, which are those of a list.
void multiply(const std::vector<Part>& parts, const CompressedRows::Row& list, Product& product) {
  const int size = parts[static_cast<std::size_t>(*list.begin())].size;
  Eigen::MatrixXd y(size, list.size());
  std::vector<Eigen::Index>& columns = product.columns;
  columns.clear();
  for (const int p : list) {
    const Part& part = parts[static_cast<std::size_t>(p)];
    if (columns.empty() || columns.back() != part.column) {
      columns.push_back(part.column);
      y.col(static_cast<Eigen::Index>(columns.size()) - 1).setZero();
    }
    y.col(static_cast<Eigen::Index>(columns.size()) - 1) +=
        part.entry * Eigen::Map<const Eigen::VectorXd>(part.values, size);
  }
  const auto active = static_cast<Eigen::Index>(columns.size());
  checkpoint(static_cast<int>(active));
  product.values.setZero(active, active);
  product.values.selfadjointView<Eigen::Lower>().rankUpdate(y.leftCols(active).transpose());
}

}  // namespace

InverseProducts::InverseProducts(std::shared_ptr<const FactoredNormalMatrix> matrix,
                                 std::shared_ptr<const WoodburyCorrection> correction, std::shared_ptr<ThreadPool> pool)
    : matrix_(std::move(matrix)),
      correction_(correction ? std::move(correction) : std::make_shared<const WoodburyCorrection>()),
      pool_(std::move(pool)),
      cholesky_(matrix_->cholesky, pool_),
      corrected_(static_cast<std::size_t>(matrix_->squared_weights.size()), -1),
      half_(corrected_.size(), -1) {
  for (std::size_t c = 0; c < correction_->rows.size(); ++c) {
    corrected_[correction_->rows[c]] = static_cast<int>(c);
  }
}

InverseProducts::~InverseProducts() = default;

/// Adds the halves that are missing.
void InverseProducts::add(const SparseMatrix& c) {
  std::vector<int> missing;
  for (const int row : Eigen::Map<const Eigen::VectorXi>(c.innerIndexPtr(), c.nonZeros())) {
    if (half_[row] < 0 && corrected_[row] < 0) {
      half_[row] = static_cast<int>(halves_.size() + missing.size());
      missing.push_back(row);
    }
  }
  try {
    std::vector<HalfColumn> more = cholesky_.half_columns(missing);
    halves_.insert(halves_.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  } catch (...) {
    for (const int row : missing) {
      half_[row] = -1;
    }
    throw;
  }
}

/// With c_h the rows of c that the factor has no weights for, and c_f the others, solves as RefinedSolver::solve() does
/// give d^T A^-1 c = d_f^T A0^-1 c_f + d_h^T W^-2 c_h - u(d)^T K u(c), where u(c) = W^-2 c_h - Z^T c_f.
Eigen::MatrixXd InverseProducts::operator()(const SparseMatrix& c) {
  add(c);
  const auto count = c.cols();
  std::vector<Part> parts;
  std::vector<int> first_rows;
  const Eigen::Index corrections = correction_->z.cols();
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(count, corrections), compliances = u;
  for (Eigen::Index k = 0; k < count; ++k) {
    for (SparseMatrix::InnerIterator entry(c, k); entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row());
      if (const int h = corrected_[row]; h >= 0) {
        compliances(k, h) = entry.value();
        u(k, h) += entry.value() / correction_->weights[static_cast<std::size_t>(h)];
        continue;
      }
      const HalfColumn& half = halves_[static_cast<std::size_t>(half_[row])];
      const double* values = half.values.data();
      for (const HalfColumn::Block& block : half.blocks) {
        parts.push_back({k, entry.value(), values, block.size});
        first_rows.push_back(block.first);
        values += block.size;
      }
      if (corrections > 0) {
        u.row(k) -= entry.value() * correction_->z.row(entry.row());
      }
    }
  }
  const CompressedRows by_block = lists_of(static_cast<int>(c.rows()), [&](const auto& use) {
    for (std::size_t p = 0; p < parts.size(); ++p) {
      use(first_rows[p], static_cast<int>(p));
    }
  });
  std::vector<int> blocks;
  for (int first = 0; first < by_block.rows(); ++first) {
    if (by_block[first].size() > 0) {
      blocks.push_back(first);
    }
  }
  // Threads share blocks, then columns, so that sums have a fixed order.
  constexpr int kShares = 8;
  constexpr std::size_t kEntries = std::size_t(1) << 22;  // of products in memory
  std::vector<Product> products;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t begin = 0, end = 0; begin < blocks.size(); begin = end) {
    for (std::size_t entries = 0; end < blocks.size() && entries < kEntries; ++end) {
      const auto size = static_cast<std::size_t>(by_block[blocks[end]].size());
      entries += size * size;
    }
    const auto together = static_cast<int>(end - begin);
    products.resize(std::max(products.size(), end - begin));
    pool_->each(together, [&](int k) {
      multiply(parts, by_block[blocks[begin + static_cast<std::size_t>(k)]], products[static_cast<std::size_t>(k)]);
    });
    pool_->each(kShares, [&](int share) {
      for (int k = 0; k < together; ++k) {
        const auto& [columns, values] = products[static_cast<std::size_t>(k)];
        const auto active = static_cast<Eigen::Index>(columns.size());
        for (Eigen::Index j = 0; j < active; ++j) {
          const Eigen::Index column = columns[static_cast<std::size_t>(j)];
          for (Eigen::Index i = column % kShares == share ? j : active; i < active; ++i) {
            result(columns[static_cast<std::size_t>(i)], column) += values(i, j);
          }
        }
      }
    });
  }
  if (corrections > 0) {
    const Eigen::MatrixXd given = compliances.leftCols(static_cast<Eigen::Index>(correction_->rows.size()));
    const Eigen::Map<const Eigen::VectorXd> weights(correction_->weights.data(), given.cols());
    result += given * weights.cwiseInverse().asDiagonal() * given.transpose() - u * correction_->k * u.transpose();
  }
  result.triangularView<Eigen::StrictlyUpper>() = result.transpose();
  return result;
}

}  // namespace lapedit
