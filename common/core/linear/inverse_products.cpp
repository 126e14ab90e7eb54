// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>
#include <utility>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/progress.h"
#include "lapedit/linear/linear.h"
#include "lapedit/linear/supernodal_solve.h"

namespace lapedit {

InverseProducts::InverseProducts(std::shared_ptr<const FactoredNormalMatrix> matrix,
                                 std::shared_ptr<const WoodburyCorrection> correction, std::shared_ptr<ThreadPool> pool)
    : matrix_(std::move(matrix)),
      correction_(correction ? std::move(correction) : std::make_shared<const WoodburyCorrection>()),
      cholesky_(matrix_->cholesky, std::move(pool)),
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
  struct Part {
    Eigen::Index column;
    double entry;
    const double* values;
    int size;
  };
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
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(count, count), y, product;
  std::vector<Eigen::Index> columns;
  for (int first = 0; first < by_block.rows(); ++first) {
    const auto list = by_block[first];
    if (list.size() == 0) {
      continue;
    }
    const int size = parts[static_cast<std::size_t>(*list.begin())].size;
    y.resize(size, list.size());
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
    product.setZero(active, active);
    product.selfadjointView<Eigen::Lower>().rankUpdate(y.leftCols(active).transpose());
    for (Eigen::Index j = 0; j < active; ++j) {
      for (Eigen::Index i = j; i < active; ++i) {
        result(columns[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)]) += product(i, j);
      }
    }
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
