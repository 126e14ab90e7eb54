// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"

namespace lapedit {

class SparseCholesky;

enum class CholeskyBackend {
  Supernodal,  ///< fronts, dense kernels and threads; SupernodalSolver solves with it
  Eigen        ///< Eigen's simplicial LDL^T: slower and simple, the reference
};

struct CholeskyOptions {
  CholeskyBackend backend = CholeskyBackend::Supernodal;
  /// Elimination order: order[k] is the row eliminated k-th. Empty: approximate minimum degree.
  std::vector<int> order;
  /// Keeps the factor in single precision: half the memory and twice the speed, and solutions with a relative error of
  /// about 1e-5, to be refined. The Eigen backend uses double.
  bool single_precision = false;
  /// Empty: the caller's thread alone.
  std::shared_ptr<ThreadPool> pool;
  /// Factor of a matrix with the same pattern, in the same order, whose analysis is reused if it has one; not kept. The
  /// bits are the same.
  const SparseCholesky* same_pattern = nullptr;
};

/// Factor of a symmetric positive definite matrix, computed once and solved with often. No other file names a
/// factorisation.
class SparseCholesky {
 public:
  struct Impl;

  /// @param matrix  compressed; both halves or the lower one: only the lower one is read
  /// @throws EditError (IllConditioned) if the matrix is not positive definite to working precision
  explicit SparseCholesky(const SparseMatrix& matrix, CholeskyBackend backend = CholeskyBackend::Supernodal);
  SparseCholesky(const SparseMatrix& matrix, const CholeskyOptions& options);
  /// Shares the immutable factor and has scratch of its own: both can solve concurrently, each with its own pool
  /// (empty: the caller's thread alone), with the same bits. O(n).
  SparseCholesky(const SparseCholesky& other, std::shared_ptr<ThreadPool> pool);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// x = matrix^-1 rhs, for three right-hand sides; rhs and x may be the same object. Allocates nothing after the first
  /// call with the same x. Cost: reading the factor twice.
  void solve(const Points& rhs, Points& x);

  /// Elimination order: row order()[k] is the k-th.
  const std::vector<int>& order() const;

  bool single_precision() const;
  const char* backend_name() const;
  /// Returns whether the analysis of CholeskyOptions::same_pattern was reused.
  bool analysis_reused() const;
  std::size_t factor_nonzeros() const;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
