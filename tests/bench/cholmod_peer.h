// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cholmod.h>

#include <Eigen/SparseCore>
#include <cstddef>
#include <string>

#include "lapedit/base/types.h"

namespace speed {

/// CHOLMOD with its defaults: supernodal, ordered by AMD.
class CholmodPeer {
 public:
  explicit CholmodPeer(const Eigen::SparseMatrix<double>& matrix);
  ~CholmodPeer();
  CholmodPeer(const CholmodPeer&) = delete;
  CholmodPeer& operator=(const CholmodPeer&) = delete;

  /// Analyses and factorises. @throws std::runtime_error if the matrix is not positive definite
  void factorise();
  lapedit::Points solve(const lapedit::Points& right);
  std::size_t factor_nonzeros() const { return factor_->xsize; }

 private:
  cholmod_common common_;
  Eigen::SparseMatrix<double> lower_;
  cholmod_factor* factor_ = nullptr;
};

/// Sets the threads of OpenBLAS below CHOLMOD, and turns off CHOLMOD's OpenMP loops, which start four threads on any
/// machine; for this program.
void set_blas_threads(int threads);
/// Returns the versions of CHOLMOD and BLAS. @throws std::runtime_error if BLAS is not OpenBLAS
std::string cholmod_version();

}  // namespace speed
