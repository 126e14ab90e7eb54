// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"

namespace lapedit {

/// An operator M over a region, stored by rows and by columns, so that products with M and M^T are sums over
/// neighbours, on several threads and with the same bits for any number of them.
class OperatorRows {
 public:
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

  OperatorRows() = default;
  explicit OperatorRows(const SparseMatrix& matrix) : OperatorRows(matrix, {}) {}
  /// Uses M^T + diag(stretch) in place of M^T. If D M is symmetric for a diagonal D and stretch is a multiple of D, the
  /// normal matrix is M^T M + stretch M, the energy |M x|^2 + x^T stretch M x. @param stretch  n; empty: none. The
  /// diagonal of M has to be complete
  OperatorRows(const SparseMatrix& matrix, const Eigen::VectorXd& stretch);

  /// out = M x. x and out must be different objects; out keeps its storage if it has the right size. O(entries).
  void apply(const Points& x, Points& out, ThreadPool& pool) const;
  /// out = M^T x, likewise.
  void apply_transposed(const Points& x, Points& out, ThreadPool& pool) const;

  /// The lower half of M^T M + diag(diagonal), compressed and sorted. O(sum of squared row lengths).
  SparseMatrix normal_matrix(const Eigen::VectorXd& diagonal, ThreadPool& pool) const;

  /// Returns the columns, the rows of M^T + diag(stretch); valid as long as this object.
  Eigen::Map<const SparseMatrix> matrix() const;
  const Rows& rows() const { return rows_; }

 private:
  Rows rows_;
  SparseMatrix columns_;         // without entries if their pattern is that of the rows, as over a region
  std::vector<double> in_rows_;  // the columns' entries in that case
};

}  // namespace lapedit
