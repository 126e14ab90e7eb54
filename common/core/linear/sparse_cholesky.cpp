// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/progress.h"
#include "lapedit/linear/linear.h"
#include "lapedit/linear/supernodal_analysis.h"
#include "lapedit/linear/supernodal_solve.h"

namespace lapedit {
namespace {

[[noreturn]] void refuse_matrix(Eigen::Index size) {
  throw EditError(ErrorCause::IllConditioned,
                  "A matrix of " + std::to_string(size) + " rows is not positive definite to working precision.");
}

/// Returns a power of two (so that no digit is lost) that scales the largest number to about 1.
double scale_of(double largest) {
  return largest > 0 && std::isfinite(largest) ? std::ldexp(1.0, std::ilogb(largest)) : 1;
}

/// Returns the lower half of a symmetric matrix whose row k is row order[k] of the given one. The entries of a column
/// are in any order.
SparseMatrix lower_in_order(const SparseMatrix& matrix, const std::vector<int>& order) {
  std::vector<int> position(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    position[order[k]] = static_cast<int>(k);
  }
  const auto each_entry = [&](const auto& use) {
    Checkpoints checkpoints;
    for (int j = 0; j < matrix.outerSize(); ++j) {
      checkpoints();
      for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
        if (entry.row() >= j) {
          const auto [column, row] = std::minmax(position[j], position[entry.row()]);
          use(column, row, entry.value());
        }
      }
    }
  };
  SparseMatrix result(matrix.rows(), matrix.rows());
  int* const offsets = result.outerIndexPtr();
  each_entry([&](int column, int, double) { ++offsets[column + 1]; });
  std::partial_sum(offsets, offsets + matrix.rows() + 1, offsets);
  result.resizeNonZeros(offsets[matrix.rows()]);
  std::vector<int> next(offsets, offsets + matrix.rows());
  each_entry([&](int column, int row, double value) {
    result.innerIndexPtr()[next[column]] = row;
    result.valuePtr()[next[column]++] = value;
  });
  return result;
}

std::shared_ptr<ThreadPool> or_alone(std::shared_ptr<ThreadPool> pool) {
  return pool ? std::move(pool) : std::make_shared<ThreadPool>(1);
}

}  // namespace

struct SparseCholesky::Impl {
  struct Analysis {
    SupernodalPattern pattern;
    Eigen::Index entries;  // of the matrix
  };

  template <typename Scalar>
  struct Solver {
    Solver(const SupernodalPattern& pattern, const SparseMatrix& matrix, ThreadPool& pool)
        : factor(pattern, lower_in_order(matrix, pattern.order), pool) {
      if (!factor.positive_definite()) {
        refuse_matrix(matrix.rows());
      }
    }
    Solver(const Solver& other, const ThreadPool& pool) : factor(other.factor, pool) {}

    /// Scales right-hand sides, solves in the order of elimination, and scales back.
    void solve(const std::vector<int>& order, const Points& rhs, Points& x, ThreadPool& pool) {
      constexpr int kGrain = 4096;
      const double scale = std::is_same_v<Scalar, float> ? scale_of(rhs.cwiseAbs().maxCoeff()) : 1;
      const auto n = static_cast<int>(order.size());
      rows.resize(n, 3);
      in_pieces(pool, n, kGrain, [&](int first, int last) {
        for (int k = first; k < last; ++k) {
          rows.row(k) = (rhs.row(order[k]) / scale).template cast<Scalar>();
        }
      });
      factor.solve(rows.data(), pool);
      x.resize(n, 3);
      in_pieces(pool, n, kGrain, [&](int first, int last) {
        for (int k = first; k < last; ++k) {
          x.row(order[k]) = scale * rows.row(k).template cast<double>();
        }
      });
    }

    SupernodalSolver<Scalar> factor;
    Eigen::Matrix<Scalar, Eigen::Dynamic, 3, Eigen::RowMajor> rows;  // in the order of elimination
  };

  std::shared_ptr<ThreadPool> pool;
  std::shared_ptr<const Analysis> analysis;
  std::optional<Solver<double>> full = {};
  std::optional<Solver<float>> single = {};

  /// @param like  of a matrix with the same pattern, or null
  static std::shared_ptr<const Analysis> analysis_of(const SparseMatrix& matrix, const std::vector<int>& order,
                                                     const std::shared_ptr<const Analysis>& like) {
    // The factorisation does not check for non-finite entries or a non-positive diagonal.
    if (!matrix.coeffs().allFinite() || !(matrix.diagonal().array() > 0).all()) {
      refuse_matrix(matrix.rows());
    }
    const bool fits = like && like->entries == matrix.nonZeros() && like->pattern.size() == matrix.rows();
    return fits ? like
                : std::make_shared<const Analysis>(Analysis{supernodal_analysis(matrix, order), matrix.nonZeros()});
  }
};

SparseCholesky::SparseCholesky(const SparseMatrix& matrix, const CholeskyOptions& options)
    : impl_(new Impl{or_alone(options.pool),
                     Impl::analysis_of(matrix, options.order,
                                       options.same_pattern ? options.same_pattern->impl_->analysis : nullptr)}) {
  if (options.single_precision) {
    impl_->single.emplace(impl_->analysis->pattern, matrix, *impl_->pool);
  } else {
    impl_->full.emplace(impl_->analysis->pattern, matrix, *impl_->pool);
  }
}
SparseCholesky::SparseCholesky(const SparseCholesky& other, std::shared_ptr<ThreadPool> pool)
    : impl_(new Impl{or_alone(std::move(pool)), other.impl_->analysis}) {
  if (other.single_precision()) {
    impl_->single.emplace(*other.impl_->single, *impl_->pool);
  } else {
    impl_->full.emplace(*other.impl_->full, *impl_->pool);
  }
}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

void SparseCholesky::solve(const Points& rhs, Points& x) {
  impl_->single ? impl_->single->solve(order(), rhs, x, *impl_->pool)
                : impl_->full->solve(order(), rhs, x, *impl_->pool);
}

std::vector<HalfColumn> SparseCholesky::half_columns(const std::vector<int>& rows) const {
  std::vector<int> position(order().size()), sought;
  for (std::size_t k = 0; k < position.size(); ++k) {
    position[order()[k]] = static_cast<int>(k);
  }
  for (const int row : rows) {
    sought.push_back(position[row]);
  }
  return impl_->single ? impl_->single->factor.half_columns(sought, *impl_->pool)
                       : impl_->full->factor.half_columns(sought, *impl_->pool);
}

const std::vector<int>& SparseCholesky::order() const {
  return impl_->analysis->pattern.order;
}
bool SparseCholesky::single_precision() const {
  return impl_->single.has_value();
}
std::size_t SparseCholesky::factor_nonzeros() const {
  return impl_->analysis->pattern.factor_nonzeros();
}

}  // namespace lapedit
