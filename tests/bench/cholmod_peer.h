// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cholmod.h>

#include <cstddef>
#include <string>

#include "system.h"

namespace speed {

/// CHOLMOD as it comes: supernodal, ordered by AMD, its own solve.
class CholmodPeer {
 public:
  explicit CholmodPeer(const Sparse& matrix);
  ~CholmodPeer();
  CholmodPeer(const CholmodPeer&) = delete;
  CholmodPeer& operator=(const CholmodPeer&) = delete;

  /// Symbolic analysis and factorisation, anew. @return whether the matrix is
  /// positive definite
  bool factorise();
  /// Three right-hand sides; the workspace is kept between calls.
  void solve(const Columns& rhs, Columns& x);
  std::size_t factor_nonzeros() const { return factor_ ? factor_->xsize : 0; }

 private:
  cholmod_common common_;
  Sparse lower_;
  cholmod_factor* factor_ = nullptr;
  cholmod_dense *solution_ = nullptr, *workspace_y_ = nullptr, *workspace_e_ = nullptr;
};

std::string cholmod_version();

/// Threads of the BLAS below CHOLMOD, if it is OpenBLAS; in this program only.
void set_blas_threads(int threads);
/// Whether CHOLMOD's loops may use OpenMP, which serves them ill: they start four threads whatever the machine has. In
/// this program only.
void set_openmp(bool allowed);
/// What OpenBLAS says of itself, or that it is another BLAS.
std::string blas_name();

}  // namespace speed
