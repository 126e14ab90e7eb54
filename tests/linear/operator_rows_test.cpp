// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/linear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "allocation_watch.h"
#include "linear/operators.h"

namespace lapedit {
namespace {

Points random_points(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  return Points::NullaryExpr(n, 3, [&] { return random() / 2147483648.0 - 1; });
}

bool same_matrix(const SparseMatrix& a, const SparseMatrix& b) {
  return a.nonZeros() == b.nonZeros() && a.cols() == b.cols() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.cols() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         std::equal(a.valuePtr(), a.valuePtr() + a.nonZeros(), b.valuePtr());
}

class OperatorRowsOn : public ::testing::TestWithParam<TriangleMesh (*)()> {
 protected:
  /// Both operators and their squares.
  static std::vector<SparseMatrix> operators() {
    std::vector<SparseMatrix> all;
    for (const bool uneven : {false, true}) {
      all.push_back(support::laplacian(GetParam()(), uneven).matrix);
      all.push_back(all.back() * all.back());
    }
    return all;
  }
};
// The large ones are cut into several pieces, the degenerate one has empty rows.
INSTANTIATE_TEST_SUITE_P(
    Shapes, OperatorRowsOn,
    ::testing::Values([] { return shapes::letter_field(80, 40); }, [] { return shapes::icosphere(2); },
                      [] { return shapes::tapered_arm(30, 110); }, [] { return shapes::degenerate_grid(50, 60); },
                      [] { return shapes::non_manifold_grid(12, 9); }, [] { return shapes::two_pieces(1); }));

/// Fails if rows and columns are mixed up, or a piece of the rows is left out.
TEST_P(OperatorRowsOn, MultipliesAsEigenDoes) {
  ThreadPool pool(2);
  for (const SparseMatrix& matrix : operators()) {
    const OperatorRows rows(matrix);
    EXPECT_TRUE(same_matrix(rows.matrix(), matrix));
    const Points x = random_points(matrix.cols(), 1);
    Points out, transposed = Points::Constant(3, 3, 7);  // of another size before
    rows.apply(x, out, pool);
    rows.apply_transposed(x, transposed, pool);
    const Points expected = matrix * x, expected_transposed = matrix.transpose() * x;
    EXPECT_LT((out - expected).norm(), 1e-14 * expected.norm());
    EXPECT_LT((transposed - expected_transposed).norm(), 1e-14 * expected_transposed.norm());
    EXPECT_GT((out - transposed).norm(), 1e-3 * expected.norm()) << "symmetric: this would say nothing";
  }
}

/// Fails if an entry of the product is missing, doubled, out of order or in the upper half, or the diagonal is not
/// added.
TEST_P(OperatorRowsOn, NormalMatrixIsTheProduct) {
  ThreadPool pool(2);
  for (const SparseMatrix& matrix : operators()) {
    const Eigen::VectorXd diagonal = random_points(matrix.cols(), 2).col(1).cwiseAbs();
    const SparseMatrix normal = OperatorRows(matrix).normal_matrix(diagonal, pool);
    ASSERT_TRUE(normal.isCompressed());
    for (int j = 0; j < normal.cols(); ++j) {
      const int* const begin = normal.innerIndexPtr() + normal.outerIndexPtr()[j];
      const int* const end = normal.innerIndexPtr() + normal.outerIndexPtr()[j + 1];
      ASSERT_TRUE(begin < end && *begin == j) << "column " << j << " has to begin on the diagonal";
      ASSERT_TRUE(std::adjacent_find(begin, end, [](int a, int b) { return a >= b; }) == end) << "column " << j;
    }
    SparseMatrix whole = SparseMatrix(matrix.transpose()) * matrix;
    for (int j = 0; j < whole.cols(); ++j) {
      whole.coeffRef(j, j) += diagonal[j];
    }
    const SparseMatrix expected = whole.triangularView<Eigen::Lower>();
    EXPECT_LT((normal - expected).norm(), 1e-14 * expected.norm());
    EXPECT_LE(normal.nonZeros(), expected.nonZeros() + matrix.cols());
  }
}

/// Fails if the order of sums depends on how the work is shared.
TEST_P(OperatorRowsOn, ThreadsDoNotChangeABit) {
  ThreadPool one(1), two(2), three(3);
  for (const SparseMatrix& matrix : operators()) {
    const OperatorRows rows(matrix);
    const Points x = random_points(matrix.cols(), 3);
    const Eigen::VectorXd diagonal = random_points(matrix.cols(), 4).col(0);
    Points out, transposed, other;
    rows.apply(x, out, one);
    rows.apply_transposed(x, transposed, one);
    const SparseMatrix normal = rows.normal_matrix(diagonal, one);
    for (ThreadPool* pool : {&two, &three}) {
      rows.apply(x, other, *pool);
      EXPECT_TRUE(support::same_bits(other, out));
      rows.apply_transposed(x, other, *pool);
      EXPECT_TRUE(support::same_bits(other, transposed));
      EXPECT_TRUE(same_matrix(rows.normal_matrix(diagonal, *pool), normal));
    }
  }
}

/// Fails if the stretch is added to the rows as well, to the wrong side, or left out of the product.
TEST_P(OperatorRowsOn, StretchIsAddedToTheTransposedAlone) {
  const support::TestOperator op = support::laplacian(GetParam()(), true);
  const Eigen::VectorXd stretch = 0.37 * op.sums;
  const OperatorRows rows(op.matrix, stretch);
  ThreadPool one(1), two(2);
  const Points x = random_points(op.matrix.cols(), 5);
  Points out, other;
  rows.apply(x, out, two);
  OperatorRows(op.matrix).apply(x, other, two);
  EXPECT_TRUE(support::same_bits(out, other));
  rows.apply_transposed(x, out, two);
  const Points expected = op.matrix.transpose() * x + stretch.asDiagonal() * x;
  EXPECT_LT((out - expected).norm(), 1e-14 * expected.norm());
  EXPECT_GT((out - op.matrix.transpose() * x).norm(), 0.1 * expected.norm());

  const Eigen::VectorXd diagonal = random_points(op.matrix.cols(), 6).col(2).cwiseAbs();
  const SparseMatrix normal = rows.normal_matrix(diagonal, two);
  SparseMatrix whole = SparseMatrix(op.matrix.transpose()) * op.matrix;
  whole += SparseMatrix(stretch.asDiagonal() * op.matrix);
  for (int j = 0; j < whole.cols(); ++j) {
    whole.coeffRef(j, j) += diagonal[j];
  }
  EXPECT_LT((whole - SparseMatrix(whole.transpose())).norm(), 1e-13 * whole.norm()) << "or half of it is not enough";
  const SparseMatrix lower = whole.triangularView<Eigen::Lower>();
  EXPECT_LT((normal - lower).norm(), 1e-14 * lower.norm());
  EXPECT_TRUE(same_matrix(rows.normal_matrix(diagonal, one), normal));
}

TEST(OperatorRows, AllocatesNothingForAProduct) {
  const TriangleMesh mesh = shapes::letter_field(80, 40);
  const OperatorRows rows(support::laplacian(mesh).matrix);
  ThreadPool pool(2);
  // A sanitizer allocates for a thread that starts: all have to be there.
  std::atomic<int> started{0};
  pool.each(pool.threads(), [&](int) {
    for (++started; started < pool.threads();) std::this_thread::yield();
  });
  Points out;
  const long before_all = allocations;
  rows.apply(mesh.vertices, out, pool);
  ASSERT_GT(allocations.load(), before_all);  // or the count does not count
  const long before = allocations;
  rows.apply(mesh.vertices, out, pool);
  rows.apply_transposed(mesh.vertices, out, pool);
  EXPECT_EQ(allocations - before, 0);
}

/// Fails if one half stays behind.
TEST(OperatorRows, SwapBothHalves) {
  const TriangleMesh mesh = shapes::icosphere(2), grid = shapes::grid(7, 9);
  const auto make = [](const TriangleMesh& of) { return OperatorRows(support::laplacian(of).matrix); };
  OperatorRows a = make(mesh), b = make(grid), empty;
  ThreadPool pool(1);
  Points expected, expected_transposed, out;
  a.apply(mesh.vertices, expected, pool);
  a.apply_transposed(mesh.vertices, expected_transposed, pool);
  std::swap(a, b);
  std::swap(b, empty);
  empty.apply(mesh.vertices, out, pool);
  EXPECT_TRUE(support::same_bits(out, expected));
  empty.apply_transposed(mesh.vertices, out, pool);
  EXPECT_TRUE(support::same_bits(out, expected_transposed));
  a.apply(grid.vertices, out, pool);
  EXPECT_EQ(out.rows(), 63);
}

}  // namespace
}  // namespace lapedit
