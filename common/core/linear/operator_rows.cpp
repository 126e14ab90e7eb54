// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/linear.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace lapedit {
namespace {

constexpr int kGrain = 1024;

/// Computes row i of out, the sum of the entries of list i times rows of x.
template <class Compressed>
void multiply(const Compressed& lists, const Points& x, Points& out, ThreadPool& pool) {
  const int* const offsets = lists.outerIndexPtr();
  const int* const inner = lists.innerIndexPtr();
  const double* const values = lists.valuePtr();
  const int n = static_cast<int>(lists.outerSize());
  out.resize(n, 3);
  in_pieces(pool, n, kGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (int k = offsets[i]; k < offsets[i + 1]; ++k) {
        sum += values[k] * x.row(inner[k]);
      }
      out.row(i) = sum;
    }
  });
}

/// Converts as Eigen does, but can be cancelled.
OperatorRows::Rows by_rows(const SparseMatrix& matrix) {
  OperatorRows::Rows rows(matrix.rows(), matrix.cols());
  int* const offsets = rows.outerIndexPtr();
  const auto each_entry = [&matrix](const auto& use) {
    Checkpoints checkpoints;
    for (int j = 0; j < matrix.outerSize(); ++j) {
      checkpoints();
      for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
        use(entry);
      }
    }
  };
  each_entry([&](const auto& entry) { ++offsets[entry.row() + 1]; });
  std::partial_sum(offsets, offsets + matrix.rows() + 1, offsets);
  rows.resizeNonZeros(offsets[matrix.rows()]);
  std::vector<int> next(offsets, offsets + matrix.rows());
  each_entry([&](const auto& entry) {
    const int to = next[static_cast<std::size_t>(entry.row())]++;
    rows.innerIndexPtr()[to] = static_cast<int>(entry.col());
    rows.valuePtr()[to] = entry.value();
  });
  return rows;
}

}  // namespace

OperatorRows::OperatorRows(const SparseMatrix& matrix, const Eigen::VectorXd& stretch)
    : rows_(by_rows(matrix)), columns_(matrix) {
  for (Eigen::Index i = 0; i < stretch.size(); ++i) {
    if (stretch[i] != 0) {
      columns_.coeffRef(i, i) += stretch[i];
    }
  }
  columns_.makeCompressed();  // a vertex without neighbours had no entry
  const Eigen::Index entries = columns_.nonZeros();
  if (entries > 0 && columns_.rows() == columns_.cols() &&
      std::equal(rows_.outerIndexPtr(), rows_.outerIndexPtr() + rows_.rows() + 1, columns_.outerIndexPtr()) &&
      std::equal(rows_.innerIndexPtr(), rows_.innerIndexPtr() + entries, columns_.innerIndexPtr())) {
    in_rows_.assign(columns_.valuePtr(), columns_.valuePtr() + entries);
    SparseMatrix().swap(columns_);  // an assignment would keep the memory
  }
}

Eigen::Map<const SparseMatrix> OperatorRows::stretched() const {
  if (in_rows_.empty()) {
    return {columns_.rows(),          columns_.cols(),          columns_.nonZeros(),
            columns_.outerIndexPtr(), columns_.innerIndexPtr(), columns_.valuePtr()};
  }
  return {rows_.rows(), rows_.cols(), rows_.nonZeros(), rows_.outerIndexPtr(), rows_.innerIndexPtr(), in_rows_.data()};
}

void OperatorRows::apply(const Points& x, Points& out, ThreadPool& pool) const {
  multiply(rows_, x, out, pool);
}

void OperatorRows::apply_left_factor(const Points& x, Points& out, ThreadPool& pool) const {
  multiply(stretched(), x, out, pool);
}

std::vector<int> OperatorRows::long_rows() const {
  std::vector<int> found;
  for (int row = 0; row < rows_.rows(); ++row) {
    if (rows_.outerIndexPtr()[row + 1] - rows_.outerIndexPtr()[row] > kLongRow) {
      found.push_back(row);
    }
  }
  return found.size() > kMostLongRows ? std::vector<int>() : found;
}

/// Computes (M^T M)_ij = sum over rows r of m_ri m_rj, for i >= j: column j is the sum of the rows of its entries, each
/// scaled by the entry.
SparseMatrix OperatorRows::normal_matrix(const Eigen::VectorXd& diagonal, ThreadPool& pool,
                                         const std::vector<int>& without) const {
  const Eigen::Map<const SparseMatrix> columns = stretched();
  std::vector<char> is_without(static_cast<std::size_t>(rows_.rows()), 0);
  for (const int row : without) {
    is_without[row] = 1;
  }
  const int n = static_cast<int>(columns.cols());
  struct Piece {
    std::vector<int> inner;
    std::vector<double> values;
  };
  const int pieces = std::max(1, std::min(n / kGrain, 4 * pool.threads()));
  std::vector<Piece> made(pieces);
  const auto begin_of = [n, pieces](int piece) {
    return static_cast<int>(static_cast<std::int64_t>(n) * piece / pieces);
  };
  SparseMatrix result(n, n);
  int* const counts = result.outerIndexPtr() + 1;
  pool.each(pieces, [&](int p) {
    Piece& piece = made[p];
    std::vector<double> sums(n, 0);
    std::vector<int> seen(n, -1), touched;
    const int first = begin_of(p), last = begin_of(p + 1);
    piece.inner.reserve(static_cast<std::size_t>(last - first) * 11);
    piece.values.reserve(static_cast<std::size_t>(last - first) * 11);
    Checkpoints checkpoints;
    for (int j = first; j < last; ++j) {
      checkpoints();
      touched.assign(1, j);
      seen[j] = j;
      sums[j] = diagonal[j];
      for (int c = columns.outerIndexPtr()[j]; c < columns.outerIndexPtr()[j + 1]; ++c) {
        const int row = columns.innerIndexPtr()[c];
        double factor = columns.valuePtr()[c];
        if (is_without[row] != 0) {
          if (row != j) {
            continue;
          }
          factor -= rows_.coeff(j, j);  // leaves the stretch
        }
        for (int r = rows_.outerIndexPtr()[row + 1] - 1; r >= rows_.outerIndexPtr()[row]; --r) {
          const int i = rows_.innerIndexPtr()[r];
          if (i < j) {
            break;  // the upper half
          }
          if (seen[i] != j) {
            seen[i] = j;
            sums[i] = 0;
            touched.push_back(i);
          }
          sums[i] += factor * rows_.valuePtr()[r];
        }
      }
      std::sort(touched.begin(), touched.end());
      for (const int i : touched) {
        piece.inner.push_back(i);
        piece.values.push_back(sums[i]);
      }
      counts[j] = static_cast<int>(touched.size());
    }
  });
  for (int j = 0; j < n; ++j) {
    counts[j] += result.outerIndexPtr()[j];
  }
  result.resizeNonZeros(result.outerIndexPtr()[n]);
  pool.each(pieces, [&](int p) {
    const int to = result.outerIndexPtr()[begin_of(p)];
    std::copy(made[p].inner.begin(), made[p].inner.end(), result.innerIndexPtr() + to);
    std::copy(made[p].values.begin(), made[p].values.end(), result.valuePtr() + to);
  });
  return result;
}

}  // namespace lapedit
