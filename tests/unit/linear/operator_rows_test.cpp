// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/linear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "linear/operators.h"

namespace lapedit::operator_rows_test {
namespace {

bool same_matrix(const SparseMatrix& a, const SparseMatrix& b) {
  return a.nonZeros() == b.nonZeros() && a.cols() == b.cols() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.cols() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr()) &&
         std::equal(a.valuePtr(), a.valuePtr() + a.nonZeros(), b.valuePtr());
}

using support::Graph;
using support::random_points;
using support::Surface;
using support::surface;

/// The large ones are cut into several pieces, the one with lone vertices has empty rows.
std::vector<Graph> graphs() {
  return {surface(Surface::Plane, 80, 40, true), surface(Surface::Torus, 12, 14, true),
          surface(Surface::Tube, 30, 110, true), together(surface(Surface::Plane, 50, 60), support::lone_vertices(5)),
          together(surface(Surface::Plane, 6, 7), surface(Surface::Plane, 4, 3))};
}

/// Both operators of all graphs and their squares.
std::vector<SparseMatrix> operators() {
  std::vector<SparseMatrix> all;
  for (const Graph& graph : graphs()) {
    for (const bool uneven : {false, true}) {
      all.push_back(support::laplacian(graph, uneven).matrix);
      all.push_back(all.back() * all.back());
    }
  }
  return all;
}

TEST(OperatorRows, MultipliesAsEigenDoes) {
  ThreadPool pool(2);
  for (const SparseMatrix& matrix : operators()) {
    const OperatorRows rows(matrix);
    EXPECT_TRUE(same_matrix(rows.stretched(), matrix));
    const Points x = random_points(matrix.cols(), 1);
    Points out, transposed = Points::Constant(3, 3, 7);  // of another size before
    rows.apply(x, out, pool);
    rows.apply_left_factor(x, transposed, pool);
    const Points expected = matrix * x, expected_transposed = matrix.transpose() * x;
    EXPECT_LT((out - expected).norm(), 1e-14 * expected.norm());
    EXPECT_LT((transposed - expected_transposed).norm(), 1e-14 * expected_transposed.norm());
    EXPECT_GT((out - transposed).norm(), 1e-3 * expected.norm()) << "symmetric: this would say nothing";
  }
}

TEST(OperatorRows, NormalMatrixIsTheProduct) {
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

TEST(OperatorRows, ThreadsDoNotChangeABit) {
  ThreadPool one(1), two(2), three(3);
  for (const SparseMatrix& matrix : operators()) {
    const OperatorRows rows(matrix);
    const Points x = random_points(matrix.cols(), 3);
    const Eigen::VectorXd diagonal = random_points(matrix.cols(), 4).col(0);
    Points out, transposed, other;
    rows.apply(x, out, one);
    rows.apply_left_factor(x, transposed, one);
    const SparseMatrix normal = rows.normal_matrix(diagonal, one);
    for (ThreadPool* pool : {&two, &three}) {
      rows.apply(x, other, *pool);
      EXPECT_TRUE(support::same_bits(other, out));
      rows.apply_left_factor(x, other, *pool);
      EXPECT_TRUE(support::same_bits(other, transposed));
      EXPECT_TRUE(same_matrix(rows.normal_matrix(diagonal, *pool), normal));
    }
  }
}

TEST(OperatorRows, StretchIsAddedToTheTransposedAlone) {
  for (const Graph& graph : graphs()) {
    const support::TestOperator op = support::laplacian(graph, true);
    const Eigen::VectorXd stretch = 0.37 * op.sums;
    const OperatorRows rows(op.matrix, stretch);
    ThreadPool one(1), two(2);
    const Points x = random_points(op.matrix.cols(), 5);
    Points out, other;
    rows.apply(x, out, two);
    OperatorRows(op.matrix).apply(x, other, two);
    EXPECT_TRUE(support::same_bits(out, other));
    rows.apply_left_factor(x, out, two);
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
}

}  // namespace
}  // namespace lapedit::operator_rows_test
