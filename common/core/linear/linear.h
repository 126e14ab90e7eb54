// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"

// All that other layers use of this library: sparse operators, a sparse Cholesky factorisation of their normal
// matrices, and refined solutions. docs/linear.md describes how it works.

namespace lapedit {

/// A row of k entries, as of a vertex in the middle of a fan, has k^2 in the normal matrix. So a factor omits a few
/// rows that are longer than this, see WoodburyCorrection.
constexpr int kLongRow = 1000, kMostLongRows = 300;

/// An operator M over a region, stored by rows and by columns, so that products with M and M^T are sums over
/// neighbours, on several threads and with the same bits for any number of them.
class OperatorRows {
 public:
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

  OperatorRows() = default;
  explicit OperatorRows(const SparseMatrix& matrix) : OperatorRows(matrix, {}) {}
  /// Uses M^T + diag(stretch) in place of M^T. If D M is symmetric for a diagonal D, and stretch is a multiple of D,
  /// the normal matrix is that of the energy |M x|^2 + x^T diag(stretch) M x.
  /// @param stretch  n, or empty for none. The diagonal of M has to be complete
  OperatorRows(const SparseMatrix& matrix, const Eigen::VectorXd& stretch);

  /// out = M x. x and out must be different objects; out keeps its storage if it has the right size. O(entries).
  void apply(const Points& x, Points& out, ThreadPool& pool) const;
  /// out = (M^T + diag(stretch)) x, likewise: the left factor of the normal matrix.
  void apply_left_factor(const Points& x, Points& out, ThreadPool& pool) const;

  /// Returns the lower half of M^T M + diag(stretch) M + diag(diagonal), compressed and sorted: symmetric, and positive
  /// semidefinite if the diagonals are not negative. O(sum of squared row lengths).
  /// @param without  rows that M^T M is computed without
  SparseMatrix normal_matrix(const Eigen::VectorXd& diagonal, ThreadPool& pool,
                             const std::vector<int>& without = {}) const;

  /// Returns the rows with more than kLongRow entries, ascending; none if there are more than kMostLongRows.
  std::vector<int> long_rows() const;

  /// Returns M + diag(stretch), whose columns are the rows of the left factor. Valid as long as this object.
  Eigen::Map<const SparseMatrix> stretched() const;
  const Rows& rows() const { return rows_; }

 private:
  Rows rows_;
  SparseMatrix columns_;         // without entries if their pattern is that of the rows, as over a region
  std::vector<double> in_rows_;  // the columns' entries in that case
};

/// Returns the elimination order for the normal matrix of an operator over a graph; empty if approximate minimum degree
/// is as good, below some ten thousand vertices.
///
/// Nested dissection with edge counts to three distant vertices as coordinates: on a surface they give 2 to 3 % more
/// fill than its own coordinates, and an edited shape keeps its order and its factor. Hubs (kLongRow) come last.
/// @param threads  at most this many (0: all of the machine's); the order does not depend on it
/// Cost: as for nested_dissection().
std::vector<int> fill_reducing_ordering(const CompressedRows& neighbours, int threads);

class SparseCholesky;
struct HalfColumn;

struct CholeskyOptions {
  /// Elimination order: order[k] is the row eliminated k-th. Empty: approximate minimum degree.
  std::vector<int> order;
  /// Keeps the factor in single precision: half the memory and twice the speed, and solutions with a relative error of
  /// about 1e-5, to be refined.
  bool single_precision = false;
  /// Empty: the caller's thread alone.
  std::shared_ptr<ThreadPool> pool;
  /// Factor of a matrix with the same pattern, in the same order, whose analysis is reused if it has one; not kept. The
  /// bits are the same.
  const SparseCholesky* same_pattern = nullptr;
};

/// The Cholesky factor of a symmetric positive definite matrix. It is computed once and serves any number of solves.
/// Other layers use factorisations through this class only.
class SparseCholesky {
 public:
  /// @param matrix  compressed; both halves or the lower one: only the lower one is read
  /// @throws EditError (IllConditioned) if the matrix is not positive definite to working precision
  explicit SparseCholesky(const SparseMatrix& matrix, const CholeskyOptions& options = {});
  /// Shares the immutable factor of another object, with scratch memory that is not shared, so that both can solve
  /// concurrently, each with its own pool (null: on the caller's thread), with the same bits. O(n).
  SparseCholesky(const SparseCholesky& other, std::shared_ptr<ThreadPool> pool);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// Solves for three right-hand sides: x = matrix^-1 rhs. Both may be the same object. Allocates nothing after the
  /// first call with the same x. Cost: reading the factor twice.
  void solve(const Points& rhs, Points& x);

  /// Returns halves of columns of the inverse, by the rows of the matrix. Cost: a fraction of a solve each.
  std::vector<HalfColumn> half_columns(const std::vector<int>& rows) const;

  /// Elimination order: row order()[k] is the k-th.
  const std::vector<int>& order() const;
  bool single_precision() const;
  std::size_t factor_nonzeros() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The matrix of the paper's normal equations (section 7) with its Cholesky factor: A0 = M^T M + W0^2, symmetric
/// positive definite. M^T M is without the long rows of M. With a stretch, OperatorRows adds diag(stretch) M.
/// Immutable, so any number of solvers can share it.
struct FactoredNormalMatrix {
  std::shared_ptr<const OperatorRows> m;
  std::vector<int> long_rows;       ///< of m
  Eigen::VectorXd squared_weights;  ///< the diagonal of W0^2, n
  SparseCholesky cholesky;          ///< each solver solves with a copy of its own

  /// Cost: one sparse Cholesky factorisation. @throws EditError (IllConditioned, BadParameter)
  FactoredNormalMatrix(std::shared_ptr<const OperatorRows> op, Eigen::VectorXd weights, const CholeskyOptions& options);
};

/// Constraints that are not part of the factor of A0 (Woodbury's formula). Let h be their rows, E the columns of the
/// identity at h, and W^2 their squared weights. With Z = A0^-1 E and K = (W^-2 + E^T Z)^-1, symmetric positive
/// definite, the system (A0 + E W^2 E^T) x = b has the solution
///
///     x = y + Z K (W^-2 b_h - y_h)
///
/// where y solves A0 y = b with b_h replaced by zero. Targets at h enter the correction directly, since solving for
/// them without these rows would give large numbers that cancel. The long rows m of M are further columns m^T of E,
/// with weight 1 and without a target. Empty without rows.
struct WoodburyCorrection {
  std::vector<int> rows;
  std::vector<double> weights;  ///< w^2 of each
  Eigen::MatrixXd z;            ///< n x columns of E
  Eigen::MatrixXd k;            ///< square
};

/// Solves A x = b, A = A0 + E W^2 E^T, with the factor of A0 and the correction, and refines solutions of A0. The
/// residual is computed through M, as b - M^T (M x) - W^2 x, and not through M^T M, so that a step also corrects the
/// squaring of the condition number.
///
/// Matrix and correction are only read and each solver has scratch of its own, so solvers that share them can work
/// concurrently, each with its own pool. One call at a time per solver. Source: N. Higham, Accuracy and Stability of
/// Numerical Algorithms, chapter 12.
class RefinedSolver {
 public:
  /// @param correction  null: A is A0
  RefinedSolver(std::shared_ptr<const FactoredNormalMatrix> matrix,
                std::shared_ptr<const WoodburyCorrection> correction, std::shared_ptr<ThreadPool> pool);

  /// Solves A0 x = b until a step changes less than `accurate` of the solution, or to double precision. @return the
  /// number of steps; -1 if it does not converge
  int refine_to(const Points& right, Points& x, double accurate);

  /// Solves A x = right once, to the precision of the factor. @param right  used as scratch. Allocates nothing after
  /// the first call.
  void solve(Points& right, Points& x);

  const FactoredNormalMatrix& matrix() const { return *matrix_; }

 private:
  std::shared_ptr<const FactoredNormalMatrix> matrix_;
  std::shared_ptr<const WoodburyCorrection> correction_;
  std::shared_ptr<ThreadPool> pool_;
  SparseCholesky cholesky_;
  Points at_rows_, corrected_;  // scratch
};

/// Products with A^-1 of vectors that have a few entries: A = A0 + E W^2 E^T, as RefinedSolver solves with it, to the
/// precision of the factor.
class InverseProducts {
 public:
  InverseProducts(std::shared_ptr<const FactoredNormalMatrix> matrix,
                  std::shared_ptr<const WoodburyCorrection> correction, std::shared_ptr<ThreadPool> pool);
  ~InverseProducts();

  /// Returns C^T A^-1 C, symmetric. Cost: a fraction of a solve for each row of C that no earlier call had an entry
  /// in, and small dense products.
  Eigen::MatrixXd operator()(const SparseMatrix& c);

 private:
  void add(const SparseMatrix& c);

  std::shared_ptr<const FactoredNormalMatrix> matrix_;
  std::shared_ptr<const WoodburyCorrection> correction_;
  std::shared_ptr<ThreadPool> pool_;
  SparseCholesky cholesky_;         // of A0
  std::vector<int> corrected_;      // per row: its column of E, or -1
  std::vector<HalfColumn> halves_;  // of rows with entries
  std::vector<int> half_;           // per row: of these, or -1
};

/// Computes the correction for rows that have no weight in A0, and for long rows.
/// @param a0  a solver without a correction
/// @return    null if a column of Z does not reach `accurate` in `most_steps` steps
/// Cost: a refined solution per three rows.
std::optional<WoodburyCorrection> woodbury_correction(RefinedSolver& a0, Eigen::Index size, std::vector<int> rows,
                                                      std::vector<double> squared_weights, double accurate,
                                                      int most_steps);

}  // namespace lapedit
