// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "lapedit/differential_operator.h"

namespace lapedit {

enum class CholeskyBackend {
  Automatic,  ///< CHOLMOD if this build has it, else Eigen
  Cholmod,    ///< SuiteSparse, supernodal
  Eigen       ///< Eigen's simplicial LDL^T
};

bool has_cholmod();

/// Factor of a symmetric positive definite matrix: made once, asked often. The only file that names a factorisation.
class SparseCholesky {
 public:
  struct Implementation;

  /// @param matrix  compressed; both halves or the lower one: only the lower one is read
  /// @throws EditError (IllConditioned) if the matrix is not positive definite to working precision; (BadParameter) if
  ///         the backend is not in this build
  explicit SparseCholesky(const SparseMatrix& matrix, CholeskyBackend backend = CholeskyBackend::Automatic);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// x = matrix^-1 rhs, for three right-hand sides; rhs and x may be the same object. Nothing is allocated after the
  /// first call with the same x. Cost: the factor read twice.
  void solve(const Points& rhs, Points& x);

  const char* backend_name() const;
  std::size_t factor_nonzeros() const;

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapedit
