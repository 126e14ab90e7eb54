// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/sparse_cholesky.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/linear/multifrontal_cholesky.h"
#include "lapedit/linear/supernodal_analysis.h"
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
    order = given.empty() ? minimum_degree(matrix) : given;
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      permutation.indices()[order[k]] = static_cast<int>(k);
    }
    SparseMatrix permuted(n, n);
    permuted.selfadjointView<Eigen::Lower>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(permutation);
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

struct SupernodalCholesky : SparseCholesky::Implementation {
  struct Analysis {
    SupernodalPattern pattern;
    Eigen::Index entries;  // of the matrix
  };

  /// @param like  of a matrix with the same pattern, or nothing
  SupernodalCholesky(const SparseMatrix& matrix, const CholeskyOptions& options, const Implementation* like)
      : Implementation(options.pool ? options.pool : std::make_shared<ThreadPool>(1)) {
    took = analysis_of(like, matrix);
    analysis =
        took
            ? took
            : std::make_shared<const Analysis>(Analysis{supernodal_analysis(matrix, options.order), matrix.nonZeros()});
    order = analysis->pattern.order;
    nonzeros = analysis->pattern.factor_nonzeros();
    const SparseMatrix lower = supernode::lower_in_order(matrix, order);
    if (options.single_precision) {
      in_single = std::make_unique<SupernodalSolver<float>>(analysis->pattern.view(), lower, *pool);
    } else {
      in_double = std::make_unique<SupernodalSolver<double>>(analysis->pattern.view(), lower, *pool);
    }
    if (!(in_single ? in_single->positive_definite() : in_double->positive_definite())) {
      refuse_matrix(matrix.rows());
    }
  }
  static std::shared_ptr<const Analysis> analysis_of(const Implementation* like, const SparseMatrix& matrix) {
    const auto* const other = dynamic_cast<const SupernodalCholesky*>(like);
    const bool fits = other && other->analysis->entries == matrix.nonZeros() &&
                      static_cast<Eigen::Index>(other->order.size()) == matrix.rows();
    return fits ? other->analysis : nullptr;
  }
  SupernodalCholesky(const SupernodalCholesky& other, std::shared_ptr<ThreadPool> used)
      : Implementation(other, std::move(used)), analysis(other.analysis), took(other.took) {
    if (other.in_single) {
      in_single = std::make_unique<SupernodalSolver<float>>(*other.in_single, *pool);
    } else {
      in_double = std::make_unique<SupernodalSolver<double>>(*other.in_double, *pool);
    }
  }
  std::unique_ptr<Implementation> share(std::shared_ptr<ThreadPool> used) const override {
    return std::make_unique<SupernodalCholesky>(*this, std::move(used));
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
  const char* name() const override { return "supernodal LLT"; }
  std::size_t bytes() const override {
    const SupernodalPattern& p = analysis->pattern;
    return (in_single ? in_single->bytes() : in_double->bytes()) +
           (p.rows.size() + p.columns.size() + p.row_offsets.size() + 2 * p.order.size()) * sizeof(int);
  }
  bool took_analysis() const override { return took != nullptr; }

  std::shared_ptr<const Analysis> analysis;
  std::shared_ptr<const Analysis> took;  // the same, or nothing
  std::unique_ptr<SupernodalSolver<float>> in_single;
  std::unique_ptr<SupernodalSolver<double>> in_double;
};

std::unique_ptr<SparseCholesky::Implementation> make(const SparseMatrix& matrix, const CholeskyOptions& options,
                                                     [[maybe_unused]] const SparseCholesky::Implementation* like) {
  // What the factorisations do not look at themselves.
  if (!matrix.coeffs().allFinite() || !(matrix.diagonal().array() > 0).all()) {
    refuse_matrix(matrix.rows());
  }
  if (options.backend != CholeskyBackend::Eigen) {
    return std::make_unique<SupernodalCholesky>(matrix, options, like);
  }
  return std::make_unique<EigenCholesky>(matrix, options.order);
}

CholeskyOptions with_backend(CholeskyBackend backend) {
  CholeskyOptions options;
  options.backend = backend;
  return options;
}

}  // namespace

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
