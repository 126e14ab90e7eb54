// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/linear.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <utility>

#include "linear/operators.h"

namespace lapedit::refined_solver_test {
namespace {

const std::vector<int> kRows = {30, 77, 78, 113};
const std::vector<double> kWeights = {100, 1, 25, 4};

/// M of a tube that is held along some of its lines, and M^T M + W^2 with and without some rows of W.
struct Problem {
  support::Graph graph;
  std::shared_ptr<ThreadPool> pool;
  std::shared_ptr<const OperatorRows> m = std::make_shared<const OperatorRows>(support::laplacian(graph).matrix);
  Eigen::VectorXd known = Eigen::VectorXd::Zero(graph.size()), all;
  Points right;
  Eigen::MatrixXd dense, dense_known;

  explicit Problem(support::Graph of = support::surface(support::Surface::Tube, 12, 20), int threads = 2)
      : graph(std::move(of)), pool(std::make_shared<ThreadPool>(threads)) {
    known.head(24).setConstant(9);
    all = known;
    for (std::size_t c = 0; c < kRows.size(); ++c) {
      all[kRows[c]] = kWeights[c];
    }
    right = support::random_points(all.size(), 3);
    const Eigen::MatrixXd op = m->stretched();
    dense_known = op.transpose() * op;
    dense = dense_known;
    dense_known.diagonal() += known;
    dense.diagonal() += all;
  }
  std::shared_ptr<const FactoredNormalMatrix> factored(const Eigen::VectorXd& weights, bool single = false) const {
    CholeskyOptions options;
    options.pool = pool;
    options.single_precision = single;
    return std::make_shared<const FactoredNormalMatrix>(m, weights, options);
  }
  std::shared_ptr<const WoodburyCorrection> correction(const std::shared_ptr<const FactoredNormalMatrix>& matrix,
                                                       double accuracy = 1e-8, bool with_rows = true) const {
    RefinedSolver solver(matrix, nullptr, pool);
    auto made = woodbury_correction(solver, all.size(), with_rows ? kRows : std::vector<int>(),
                                    with_rows ? kWeights : std::vector<double>(), accuracy, accuracy < 1e-8 ? 40 : 8);
    EXPECT_TRUE(made.has_value());
    return std::make_shared<const WoodburyCorrection>(*made);
  }
};

/// Solves A x = b as edits do: residuals of A, and solves with the factor. @return the number of solves
int refine(RefinedSolver& solver, const Eigen::MatrixXd& a, const Points& right, Points& x) {
  Points left = right, step;
  x.setZero(right.rows(), 3);
  int count = 0;
  for (double change = 1; change > 1e-12 && count < 30; ++count) {
    solver.solve(left, step);
    x += step;
    left = right - a * x;
    change = step.norm() / x.norm();
  }
  return count;
}

TEST(RefinedSolver, AgreesWithADenseSolve) {
  const Problem p;
  const Points expected = p.dense_known.ldlt().solve(p.right);
  for (const bool single : {false, true}) {
    RefinedSolver solver(p.factored(p.known, single), nullptr, p.pool);
    Points coarse;
    EXPECT_GE(solver.refine_to(p.right, coarse, 1e-8), single && solver.matrix().cholesky.single_precision() ? 1 : 0);
    EXPECT_LT((coarse - expected).norm(), 1e-7 * expected.norm());
  }
}

TEST(RefinedSolver, CorrectedFactorGivesTheBitsOfAFactorThatKnowsAllRows) {
  const Problem p;
  const auto known = p.factored(p.known);
  RefinedSolver corrected(known, p.correction(known), p.pool);
  Points found;
  EXPECT_LT(refine(corrected, p.dense, p.right, found), 8) << "a wrong correction is a slow one";
  EXPECT_LT((found - p.dense.ldlt().solve(p.right)).norm(), 1e-10 * found.norm());
}

/// The middle of a fan: the square of its neighbours' number is neither in the matrix nor in the factor.
TEST(RefinedSolver, LongRowIsCorrectedInsteadOfFactored) {
  const support::Graph wheel = support::wheel(kLongRow + 100);
  const int hub = wheel.size() - 1;
  Problem p(wheel);
  EXPECT_EQ(p.m->long_rows(), std::vector<int>{hub});
  EXPECT_LT(p.m->normal_matrix(p.known, *p.pool, {hub}).nonZeros(), 8 * hub);
  EXPECT_GT(p.m->normal_matrix(p.known, *p.pool).nonZeros(), hub * hub / 2);
  for (const bool stretched : {false, true}) {
    const support::TestOperator op = support::laplacian(wheel, true);
    const Eigen::VectorXd stretch = stretched ? Eigen::VectorXd(0.02 * op.sums) : Eigen::VectorXd();
    p.m = std::make_shared<const OperatorRows>(op.matrix, stretch);
    const Eigen::MatrixXd m = op.matrix;
    Eigen::MatrixXd dense = m.transpose() * m;
    if (stretched) {
      dense += stretch.asDiagonal() * m;
    }
    dense.diagonal() += p.all;
    const Points expected = dense.ldlt().solve(p.right);
    for (const bool single : {false, true}) {
      const auto known = p.factored(p.known, single);
      EXPECT_LT(known->cholesky.factor_nonzeros(), 40U * hub);
      RefinedSolver solver(known, p.correction(known), p.pool);
      Points found;
      EXPECT_LT(refine(solver, dense, p.right, found), 8);
      EXPECT_LT((found - expected).norm(), 1e-11 * expected.norm()) << stretched << single;
    }
  }
}

TEST(RefinedSolver, CorrectionThatTakesTooManyStepsIsNone) {
  const Problem p;
  const auto single = p.factored(p.known, true);
  RefinedSolver solver(single, nullptr, p.pool);
  EXPECT_TRUE(woodbury_correction(solver, p.all.size(), kRows, kWeights, 1e-8, 8).has_value());
  EXPECT_FALSE(woodbury_correction(solver, p.all.size(), kRows, kWeights, 1e-8, 0).has_value());
}

TEST(RefinedSolver, SolversThatShareAMatrixWorkAtATime) {
  const Problem p;
  const auto matrix = p.factored(p.known, true);
  const auto correction = p.correction(matrix);
  Points right = p.right, expected;
  RefinedSolver(matrix, correction, p.pool).solve(right, expected);
  std::vector<Points> found(3);
  ThreadPool(3).each(3, [&](int k) {
    RefinedSolver solver(matrix, correction, std::make_shared<ThreadPool>(1 + k % 2));
    for (int time = 0; time < 10; ++time) {
      Points scratch = (k + 2) * p.right;
      solver.solve(scratch, found[k]);
      scratch = p.right;
      solver.solve(scratch, found[k]);
    }
  });
  for (const Points& x : found) {
    EXPECT_TRUE(support::same_bits(x, expected));
  }
}

SparseMatrix vectors(Eigen::Index size, const std::vector<std::vector<int>>& rows) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (const int row : rows[k]) {
      entries.emplace_back(row, static_cast<int>(k), 0.3 + row % 5 - 0.1 * static_cast<double>(k));
    }
  }
  SparseMatrix c(size, static_cast<Eigen::Index>(rows.size()));
  c.setFromTriplets(entries.begin(), entries.end());
  return c;
}

void expect_products(const support::Graph& graph, bool with_rows) {
  for (const bool single : {false, true}) {
    std::vector<Eigen::MatrixXd> found;
    for (const int threads : {1, 3}) {
      const Problem p(graph, threads);
      const auto matrix = p.factored(p.known, single);
      const bool corrected = with_rows || !matrix->long_rows.empty();
      InverseProducts products(matrix, corrected ? p.correction(matrix, 1e-10, with_rows) : nullptr, p.pool);
      const SparseMatrix c =
          vectors(graph.size(), {{5}, {}, {77, 78, 79, 239}, {113, 30}, {3, 120, 0}, {150, 151, 152}});
      if (threads > 1) {
        products(vectors(graph.size(), {{0, 1, 2}, {77}, {30, 200, 113}}));
      }
      const Eigen::MatrixXd whole = c,
                            expected = c.transpose() * (with_rows ? p.dense : p.dense_known).ldlt().solve(whole);
      found.push_back(products(c));
      EXPECT_LT((found.back() - expected).norm(), (single ? 1e-4 : 1e-9) * expected.norm());
      EXPECT_TRUE(found.back() == found.front()) << "the bits depend on threads or earlier calls";
      EXPECT_EQ(products(SparseMatrix(graph.size(), 0)).size(), 0);
    }
  }
}

TEST(InverseProducts, AgreeWithADenseInverse) {
  expect_products(support::surface(support::Surface::Tube, 12, 20), false);
  expect_products(support::surface(support::Surface::Tube, 12, 20), true);
  expect_products(support::wheel(kLongRow + 100), true);
}

}  // namespace
}  // namespace lapedit::refined_solver_test
