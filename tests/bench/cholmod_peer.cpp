// SPDX-License-Identifier: GPL-3.0-or-later
#include "cholmod_peer.h"

#include <dlfcn.h>

namespace speed {

CholmodPeer::CholmodPeer(const Sparse& matrix) : common_(), lower_(matrix.triangularView<Eigen::Lower>()) {
  cholmod_start(&common_);
  common_.print = 0;
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_AMD;
  common_.supernodal = CHOLMOD_SUPERNODAL;
}

CholmodPeer::~CholmodPeer() {
  cholmod_free_dense(&solution_, &common_);
  cholmod_free_dense(&workspace_y_, &common_);
  cholmod_free_dense(&workspace_e_, &common_);
  cholmod_free_factor(&factor_, &common_);
  cholmod_finish(&common_);
}

bool CholmodPeer::factorise() {
  cholmod_free_factor(&factor_, &common_);
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = static_cast<std::size_t>(lower_.rows());
  matrix.nzmax = static_cast<std::size_t>(lower_.nonZeros());
  matrix.p = lower_.outerIndexPtr();
  matrix.i = lower_.innerIndexPtr();
  matrix.x = lower_.valuePtr();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = 1;
  matrix.packed = 1;
  factor_ = cholmod_analyze(&matrix, &common_);
  return factor_ && cholmod_factorize(&matrix, factor_, &common_) && common_.status == CHOLMOD_OK;
}

void CholmodPeer::solve(const Columns& rhs, Columns& x) {
  cholmod_dense b{};
  b.nrow = b.d = static_cast<std::size_t>(rhs.rows());
  b.ncol = 3;
  b.nzmax = b.nrow * 3;
  b.x = const_cast<double*>(rhs.data());
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, factor_, &b, nullptr, &solution_, nullptr, &workspace_y_, &workspace_e_, &common_);
  x = Eigen::Map<const Columns>(static_cast<const double*>(solution_->x), rhs.rows(), 3);
}

std::string cholmod_version() {
  int version[3];
  ::cholmod_version(version);
  return std::to_string(version[0]) + "." + std::to_string(version[1]) + "." + std::to_string(version[2]);
}

void set_blas_threads(int threads) {
  // Looked up at run time: which BLAS is behind libblas.so.3 is the system's
  // choice.
  static const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
  if (set) {
    set(threads);
  }
}

void set_openmp(bool allowed) {
  static const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"));
  if (set) {
    set(allowed ? 1 : 0);
  }
}

std::string blas_name() {
  const auto config = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_config"));
  return config ? config() : "not OpenBLAS";
}

}  // namespace speed
