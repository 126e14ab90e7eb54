// SPDX-License-Identifier: GPL-3.0-or-later
#include "cholmod_peer.h"

#include <dlfcn.h>

#include <stdexcept>

namespace speed {

CholmodPeer::CholmodPeer(const Eigen::SparseMatrix<double>& matrix)
    : common_(), lower_(matrix.triangularView<Eigen::Lower>()) {
  cholmod_start(&common_);
  common_.print = 0;
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_AMD;
  common_.supernodal = CHOLMOD_SUPERNODAL;
}

CholmodPeer::~CholmodPeer() {
  cholmod_free_factor(&factor_, &common_);
  cholmod_finish(&common_);
}

void CholmodPeer::factorise() {
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
  matrix.sorted = matrix.packed = 1;
  factor_ = cholmod_analyze(&matrix, &common_);
  if (factor_ == nullptr || cholmod_factorize(&matrix, factor_, &common_) == 0 || common_.status != CHOLMOD_OK) {
    throw std::runtime_error("CHOLMOD finds the matrix not positive definite");
  }
}

lapedit::Points CholmodPeer::solve(const lapedit::Points& right) {
  Eigen::MatrixXd columns = right;
  cholmod_dense b{};
  b.nrow = b.d = static_cast<std::size_t>(columns.rows());
  b.ncol = 3;
  b.nzmax = b.nrow * 3;
  b.x = columns.data();
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor_, &b, &common_);
  lapedit::Points result = Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x->x), columns.rows(), 3);
  cholmod_free_dense(&x, &common_);
  return result;
}

void set_blas_threads(int threads) {
  // Looked up at run time, since the system chooses the library behind libblas.so.3.
  if (const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) {
    set(threads);
  }
  if (const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"))) {
    set(0);
  }
}

std::string cholmod_version() {
  const auto blas = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_config"));
  if (blas == nullptr) {
    throw std::runtime_error("CHOLMOD's BLAS is not OpenBLAS: point libblas.so.3 and liblapack.so.3 to it");
  }
  int version[3];
  ::cholmod_version(version);
  return "CHOLMOD " + std::to_string(version[0]) + "." + std::to_string(version[1]) + "." + std::to_string(version[2]) +
         ", " + blas();
}

}  // namespace speed
