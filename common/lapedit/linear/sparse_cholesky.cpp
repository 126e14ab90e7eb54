// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/sparse_cholesky.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <utility>
#ifdef LAPEDIT_HAVE_CHOLMOD
#include <cholmod.h>
#endif

#include "lapedit/base/error.h"
#include "lapedit/linear/multifrontal_cholesky.h"
#include "lapedit/linear/supernodal_solve.h"

namespace lapedit {
namespace {

[[noreturn]] void refuse_matrix(Eigen::Index size) {
  throw EditError(ErrorCause::IllConditioned,
                  "The system of " + std::to_string(size) +
                      " region vertices is singular to working precision: use a lower order, a smaller region, more "
                      "padding or weights nearer to 1.");
}

}  // namespace

struct SparseCholesky::Implementation {
  explicit Implementation(std::shared_ptr<ThreadPool> used) : pool(std::move(used)) {}
  /// Shares the factor; the scratch is made when it is needed.
  Implementation(const Implementation& other, std::shared_ptr<ThreadPool> used)
      : pool(std::move(used)), order(other.order), nonzeros(other.nonzeros) {}
  Implementation& operator=(const Implementation&) = delete;
  virtual ~Implementation() = default;
  virtual std::unique_ptr<Implementation> share(std::shared_ptr<ThreadPool> pool) const = 0;
  virtual void solve_in_order(double* x) = 0;
  virtual void solve_in_order(float* x) = 0;
  virtual bool single_precision() const = 0;
  virtual const char* name() const = 0;
  virtual std::size_t bytes() const = 0;
  virtual bool took_analysis() const { return false; }
  virtual void solve(const Points& rhs, Points& x) { solve_with(ordered, 1, rhs, x); }

  /// Scaled right-hand sides in the order of elimination, their solution, and back.
  template <class Ordered>
  void solve_with(Ordered& rows, double scale, const Points& rhs, Points& x) {
    constexpr int kGrain = 4096;
    const auto n = static_cast<int>(order.size());
    rows.resize(n, 3);
    in_pieces(*pool, n, kGrain, [&](int first, int last) {
      for (int k = first; k < last; ++k) {
        rows.row(k) = (rhs.row(order[k]) / scale).template cast<typename Ordered::Scalar>();
      }
    });
    solve_in_order(rows.data());
    x.resize(n, 3);
    in_pieces(*pool, n, kGrain, [&](int first, int last) {
      for (int k = first; k < last; ++k) {
        x.row(order[k]) = scale * rows.row(k).template cast<double>();
      }
    });
  }

  std::shared_ptr<ThreadPool> pool;
  std::vector<int> order;
  std::size_t nonzeros = 0;
  Points ordered;  // in the order of elimination
  Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> ordered_single;
};

/// A power of two, so that no digit is lost, which makes the largest number about 1.
double scale_of(double largest) {
  return largest > 0 && std::isfinite(largest) ? std::ldexp(1.0, std::ilogb(largest)) : 1;
}

namespace {

struct EigenCholesky : SparseCholesky::Implementation {
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  using Natural = Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, Eigen::NaturalOrdering<int>>;

  struct Factor {
    Natural ldlt;
    Eigen::VectorXd pivots;
  };

  EigenCholesky(const SparseMatrix& matrix, const std::vector<int>& given)
      : Implementation(std::make_shared<ThreadPool>(1)) {
    const Eigen::Index n = matrix.rows();
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(n);
    if (given.empty()) {
      const SparseMatrix whole = matrix.selfadjointView<Eigen::Lower>();
      Eigen::AMDOrdering<int>()(whole, permutation);
      permutation = permutation.inverse().eval();
    } else {
      for (Eigen::Index k = 0; k < n; ++k) {
        permutation.indices()[given[k]] = static_cast<int>(k);
      }
    }
    SparseMatrix permuted(n, n);
    permuted.selfadjointView<Eigen::Lower>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(permutation);
    order.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      order[permutation.indices()[i]] = static_cast<int>(i);
    }
    auto made = std::make_shared<Factor>();
    made->ldlt.compute(permuted);
    if (made->ldlt.info() != Eigen::Success) {
      refuse_matrix(n);
    }
    made->pivots = made->ldlt.vectorD();
    if (!(made->pivots.array() > 0).all()) {
      refuse_matrix(n);
    }
    nonzeros = static_cast<std::size_t>(made->ldlt.matrixL().nestedExpression().nonZeros());
    factor = std::move(made);
  }
  EigenCholesky(const EigenCholesky& other, std::shared_ptr<ThreadPool> used)
      : Implementation(other, std::move(used)), factor(other.factor) {}
  std::unique_ptr<Implementation> share(std::shared_ptr<ThreadPool> used) const override {
    return std::make_unique<EigenCholesky>(*this, std::move(used));
  }
  void solve_in_order(double* x) override {
    Eigen::Map<Points> rows(x, size(), 3);
    scratch = rows;
    solve_scratch();
    rows = scratch;
  }
  void solve_in_order(float* x) override {
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>> rows(x, size(), 3);
    scratch = rows.cast<double>();
    solve_scratch();
    rows = scratch.cast<float>();
  }
  void solve_scratch() {
    factor->ldlt.matrixL().solveInPlace(scratch);
    scratch.array().colwise() /= factor->pivots.array();
    factor->ldlt.matrixU().solveInPlace(scratch);
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(order.size()); }
  bool single_precision() const override { return false; }
  const char* name() const override { return "Eigen simplicial LDLT"; }
  std::size_t bytes() const override { return nonzeros * (sizeof(double) + sizeof(int)); }

  std::shared_ptr<const Factor> factor;
  Columns scratch;  // each right-hand side contiguous, as the factor wants it
};

#ifdef LAPEDIT_HAVE_CHOLMOD
/// CHOLMOD's objects, freed in any case.
struct CholmodFactor {
  CholmodFactor() { cholmod_start(&common); }
  ~CholmodFactor() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;
  cholmod_common common{};
  cholmod_factor* factor = nullptr;  // symbolic
  Eigen::Index entries = 0;          // of the matrix
};

struct CholmodCholesky : SparseCholesky::Implementation {
  /// @param like  of a matrix with the same pattern, or nothing
  CholmodCholesky(const SparseMatrix& matrix, const CholeskyOptions& options, const Implementation* like)
      : Implementation(options.pool ? options.pool : std::make_shared<ThreadPool>(1)) {
    took = analysis_of(like, matrix);
    analysis = took ? took : analyse(matrix, options);
    const cholmod_factor* const l = analysis->factor;
    const int* const permutation = static_cast<const int*>(l->Perm);
    order.assign(permutation, permutation + l->n);
    SupernodalFactor raw;
    raw.size = static_cast<int>(l->n);
    raw.supernodes = static_cast<int>(l->nsuper);
    raw.columns = static_cast<const int*>(l->super);
    raw.row_offsets = static_cast<const int*>(l->pi);
    raw.value_offsets = static_cast<const int*>(l->px);
    raw.rows = static_cast<const int*>(l->s);
    nonzeros = l->xsize;
    const SparseMatrix lower = supernode::lower_in_order(matrix, order);
    if (options.single_precision) {
      in_single = std::make_unique<SupernodalSolver<float>>(raw, lower, *pool);
    } else {
      in_double = std::make_unique<SupernodalSolver<double>>(raw, lower, *pool);
    }
    if (!(in_single ? in_single->positive_definite() : in_double->positive_definite())) {
      refuse_matrix(matrix.rows());
    }
  }
  static std::shared_ptr<const CholmodFactor> analysis_of(const Implementation* like, const SparseMatrix& matrix) {
    const auto* const other = dynamic_cast<const CholmodCholesky*>(like);
    const bool fits = other && other->analysis->entries == matrix.nonZeros() &&
                      static_cast<Eigen::Index>(other->order.size()) == matrix.rows();
    return fits ? other->analysis : nullptr;
  }
  static std::shared_ptr<const CholmodFactor> analyse(const SparseMatrix& matrix, const CholeskyOptions& options) {
    const auto made = std::make_shared<CholmodFactor>();
    made->entries = matrix.nonZeros();
    cholmod_common& common = made->common;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = options.order.empty() ? CHOLMOD_AMD : CHOLMOD_GIVEN;
    common.print = 0;  // an indefinite matrix is our refusal, not a line on the host's terminal
    cholmod_sparse view{};
    view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
    view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
    view.p = const_cast<int*>(matrix.outerIndexPtr());
    view.i = const_cast<int*>(matrix.innerIndexPtr());
    view.x = const_cast<double*>(matrix.valuePtr());
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = view.packed = 1;
    int* const given = options.order.empty() ? nullptr : const_cast<int*>(options.order.data());
    made->factor = cholmod_analyze_p(&view, given, nullptr, 0, &common);
    if (common.status == CHOLMOD_OUT_OF_MEMORY) {
      throw std::bad_alloc();
    }
    const cholmod_factor* const l = made->factor;
    if (common.status != CHOLMOD_OK || !l || !l->is_super) {
      refuse_matrix(matrix.rows());
    }
    return made;
  }
  CholmodCholesky(const CholmodCholesky& other, std::shared_ptr<ThreadPool> used)
      : Implementation(other, std::move(used)), analysis(other.analysis), took(other.took) {
    if (other.in_single) {
      in_single = std::make_unique<SupernodalSolver<float>>(*other.in_single, *pool);
    } else {
      in_double = std::make_unique<SupernodalSolver<double>>(*other.in_double, *pool);
    }
  }
  std::unique_ptr<Implementation> share(std::shared_ptr<ThreadPool> used) const override {
    return std::make_unique<CholmodCholesky>(*this, std::move(used));
  }
  void solve_in_order(double* x) override {
    if (in_double) {
      in_double->solve(x, *pool);
      return;
    }
    Eigen::Map<Points> rows(x, static_cast<Eigen::Index>(order.size()), 3);
    const double scale = scale_of(rows.cwiseAbs().maxCoeff());
    ordered_single = (rows / scale).cast<float>();
    in_single->solve(ordered_single.data(), *pool);
    rows = scale * ordered_single.cast<double>();
  }
  void solve(const Points& rhs, Points& x) override {
    if (in_single) {
      solve_with(ordered_single, scale_of(rhs.cwiseAbs().maxCoeff()), rhs, x);
    } else {
      solve_with(ordered, 1, rhs, x);
    }
  }
  void solve_in_order(float* x) override {
    if (in_single) {
      in_single->solve(x, *pool);
      return;
    }
    const auto n = static_cast<Eigen::Index>(order.size());
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>> rows(x, n, 3);
    ordered = rows.cast<double>();
    in_double->solve(ordered.data(), *pool);
    rows = ordered.cast<float>();
  }
  bool single_precision() const override { return in_single != nullptr; }
  const char* name() const override { return "CHOLMOD supernodal LLT"; }
  std::size_t bytes() const override {
    const cholmod_factor& l = *analysis->factor;
    return (in_single ? in_single->bytes() : in_double->bytes()) + (l.ssize + 3 * l.nsuper + 2 * l.n) * sizeof(int);
  }
  bool took_analysis() const override { return took != nullptr; }

  std::shared_ptr<const CholmodFactor> analysis;
  std::shared_ptr<const CholmodFactor> took;  // the same, or nothing
  std::unique_ptr<SupernodalSolver<float>> in_single;
  std::unique_ptr<SupernodalSolver<double>> in_double;
};
#endif

std::unique_ptr<SparseCholesky::Implementation> make(const SparseMatrix& matrix, const CholeskyOptions& options,
                                                     [[maybe_unused]] const SparseCholesky::Implementation* like) {
  // What the factorisations do not look at themselves.
  if (!matrix.coeffs().allFinite() || !(matrix.diagonal().array() > 0).all()) {
    refuse_matrix(matrix.rows());
  }
#ifdef LAPEDIT_HAVE_CHOLMOD
  if (options.backend != CholeskyBackend::Eigen) {
    return std::make_unique<CholmodCholesky>(matrix, options, like);
  }
#else
  if (options.backend == CholeskyBackend::Cholmod) {
    throw EditError(ErrorCause::BadParameter, "This build has no CHOLMOD: choose the automatic or the Eigen backend.");
  }
#endif
  return std::make_unique<EigenCholesky>(matrix, options.order);
}

CholeskyOptions with_backend(CholeskyBackend backend) {
  CholeskyOptions options;
  options.backend = backend;
  return options;
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
    : SparseCholesky(matrix, with_backend(backend)) {}
SparseCholesky::SparseCholesky(const SparseMatrix& matrix, const CholeskyOptions& options)
    : implementation_(
          make(matrix, options, options.same_pattern ? options.same_pattern->implementation_.get() : nullptr)) {}
SparseCholesky::SparseCholesky(const SparseCholesky& other, std::shared_ptr<ThreadPool> pool)
    : implementation_(other.implementation_->share(pool ? std::move(pool) : std::make_shared<ThreadPool>(1))) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

void SparseCholesky::solve(const Points& rhs, Points& x) {
  implementation_->solve(rhs, x);
}

void SparseCholesky::solve_in_order(float* x) {
  implementation_->solve_in_order(x);
}
void SparseCholesky::solve_in_order(double* x) {
  implementation_->solve_in_order(x);
}
const std::vector<int>& SparseCholesky::order() const {
  return implementation_->order;
}
bool SparseCholesky::single_precision() const {
  return implementation_->single_precision();
}
const char* SparseCholesky::backend_name() const {
  return implementation_->name();
}
bool SparseCholesky::took_analysis() const {
  return implementation_->took_analysis();
}
std::size_t SparseCholesky::factor_nonzeros() const {
  return implementation_->nonzeros;
}
std::size_t SparseCholesky::bytes() const {
  return implementation_->bytes();
}

}  // namespace lapedit
