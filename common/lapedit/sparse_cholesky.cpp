// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/sparse_cholesky.h"

#include <Eigen/SparseCholesky>
#ifdef LAPEDIT_HAVE_CHOLMOD
#include <Eigen/CholmodSupport>
#endif

#include "lapedit/error.h"

namespace lapedit {

namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // factorisations want each right-hand side contiguous

[[noreturn]] void refuse_matrix(Eigen::Index size) {
  throw EditError(ErrorCause::IllConditioned,
                  "The system of " + std::to_string(size) +
                      " region vertices is singular to working precision: use a lower order, a smaller region, more "
                      "padding or weights nearer to 1.");
}

}  // namespace

struct SparseCholesky::Implementation {
  virtual ~Implementation() = default;
  virtual void solve(Columns& columns) = 0;
  virtual const char* name() const = 0;
  virtual std::size_t nonzeros() const = 0;
  Columns columns;
};

namespace {

struct EigenCholesky : SparseCholesky::Implementation {
  explicit EigenCholesky(const SparseMatrix& matrix)
      : factor(matrix), pivots(factor.vectorD()), scratch(matrix.rows(), 3) {
    if (factor.info() != Eigen::Success || !(pivots.array() > 0).all()) {
      refuse_matrix(matrix.rows());
    }
  }
  void solve(Columns& x) override {
    scratch.noalias() = factor.permutationP() * x;
    factor.matrixL().solveInPlace(scratch);
    scratch.array().colwise() /= pivots.array();
    factor.matrixU().solveInPlace(scratch);
    x.noalias() = factor.permutationPinv() * scratch;
  }
  const char* name() const override { return "Eigen simplicial LDLT"; }
  std::size_t nonzeros() const override {
    return static_cast<std::size_t>(factor.matrixL().nestedExpression().nonZeros());
  }

  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower> factor;
  Eigen::VectorXd pivots;  // vectorD() makes a copy at each call
  Columns scratch;
};

#ifdef LAPEDIT_HAVE_CHOLMOD
/// Eigen's wrapper, opened for the solve that keeps its workspace.
class SupernodalLLT : public Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> {
 public:
  cholmod_factor* raw_factor() { return m_cholmodFactor; }
};

struct CholmodCholesky : SparseCholesky::Implementation {
  explicit CholmodCholesky(const SparseMatrix& matrix) {
    cholmod_common& common = factor.cholmod();
    common.nmethods = 1;  // METIS orders better, but takes longer than it saves at these sizes
    common.method[0].ordering = CHOLMOD_AMD;
    common.print = 0;  // an indefinite matrix is our refusal, not a line on the host's terminal
    factor.compute(matrix);
    if (factor.info() != Eigen::Success || common.status != CHOLMOD_OK) {
      refuse_matrix(matrix.rows());
    }
  }
  ~CholmodCholesky() override {
    cholmod_common* common = &factor.cholmod();
    cholmod_free_dense(&solution, common);
    cholmod_free_dense(&workspace_y, common);
    cholmod_free_dense(&workspace_e, common);
  }
  void solve(Columns& x) override {
    cholmod_dense rhs{};
    rhs.nrow = rhs.d = static_cast<std::size_t>(x.rows());
    rhs.ncol = 3;
    rhs.nzmax = rhs.nrow * 3;
    rhs.x = x.data();
    rhs.xtype = CHOLMOD_REAL;
    rhs.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_solve2(CHOLMOD_A, factor.raw_factor(), &rhs, nullptr, &solution, nullptr, &workspace_y, &workspace_e,
                        &factor.cholmod())) {
      refuse_matrix(x.rows());
    }
    x = Eigen::Map<const Columns>(static_cast<const double*>(solution->x), x.rows(), 3);
  }
  const char* name() const override { return "CHOLMOD supernodal LLT"; }
  std::size_t nonzeros() const override { return factor_size; }

  SupernodalLLT factor;
  std::size_t factor_size = 0;
  cholmod_dense* solution = nullptr;
  cholmod_dense* workspace_y = nullptr;
  cholmod_dense* workspace_e = nullptr;
};
#endif

std::unique_ptr<SparseCholesky::Implementation> make(const SparseMatrix& matrix, CholeskyBackend backend) {
  // What the factorisations do not look at themselves.
  if (!matrix.coeffs().allFinite() || !(matrix.diagonal().array() > 0).all()) {
    refuse_matrix(matrix.rows());
  }
#ifdef LAPEDIT_HAVE_CHOLMOD
  if (backend != CholeskyBackend::Eigen) {
    auto cholmod = std::make_unique<CholmodCholesky>(matrix);
    cholmod->factor_size = cholmod->factor.raw_factor()->xsize;
    return cholmod;
  }
#else
  if (backend == CholeskyBackend::Cholmod) {
    throw EditError(ErrorCause::BadParameter, "This build has no CHOLMOD: choose the automatic or the Eigen backend.");
  }
#endif
  return std::make_unique<EigenCholesky>(matrix);
}

}  // namespace

bool has_cholmod() {
#ifdef LAPEDIT_HAVE_CHOLMOD
  return true;
#else
  return false;
#endif
}

SparseCholesky::SparseCholesky(const SparseMatrix& matrix, CholeskyBackend backend)
    : implementation_(make(matrix, backend)) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

void SparseCholesky::solve(const Points& rhs, Points& x) {
  Columns& columns = implementation_->columns;
  columns = rhs;
  implementation_->solve(columns);
  x = columns;
}

const char* SparseCholesky::backend_name() const {
  return implementation_->name();
}
std::size_t SparseCholesky::factor_nonzeros() const {
  return implementation_->nonzeros();
}

}  // namespace lapedit
