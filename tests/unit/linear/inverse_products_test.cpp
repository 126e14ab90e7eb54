// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "lapedit/linear/linear.h"
#include "linear/operators.h"

namespace lapedit::inverse_products_test {
namespace {

/// A tube that is held along its end, with a hub of a long row, and with rows that the factor has no weights for.
struct Problem {
  std::shared_ptr<ThreadPool> pool;
  std::shared_ptr<const FactoredNormalMatrix> matrix;
  std::shared_ptr<const WoodburyCorrection> correction;
  Eigen::MatrixXd inverse;

  Problem(int threads, bool single, const support::Graph& graph, const std::vector<int>& rows)
      : pool(std::make_shared<ThreadPool>(threads)) {
    const auto m = std::make_shared<const OperatorRows>(support::laplacian(graph).matrix);
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(graph.size());
    weights.head(24).setConstant(9);
    CholeskyOptions options;
    options.pool = pool;
    options.single_precision = single;
    matrix = std::make_shared<const FactoredNormalMatrix>(m, weights, options);
    const Eigen::MatrixXd op = m->stretched();
    Eigen::MatrixXd dense = op.transpose() * op;
    dense.diagonal() += weights;
    std::vector<double> more;
    for (const int row : rows) {
      more.push_back(4.0 + row % 7);
      dense(row, row) += more.back();
    }
    if (!rows.empty() || !matrix->long_rows.empty()) {
      RefinedSolver solver(matrix, nullptr, pool);
      correction =
          std::make_shared<const WoodburyCorrection>(*woodbury_correction(solver, graph.size(), rows, more, 1e-10, 40));
    }
    inverse = dense.inverse();
  }
};

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

void expect_products(const support::Graph& graph, const std::vector<int>& rows) {
  for (const bool single : {false, true}) {
    const Problem one(1, single, graph, rows), three(3, single, graph, rows);
    InverseProducts a(one.matrix, one.correction, one.pool), b(three.matrix, three.correction, three.pool);
    const SparseMatrix first = vectors(graph.size(), {{0, 1, 2}, {77}, {30, 200, 113}});
    const SparseMatrix c = vectors(graph.size(), {{5}, {}, {77, 78, 79, 239}, {113, 30}, {3, 120, 0}, {150, 151, 152}});
    const Eigen::MatrixXd expected = c.transpose() * one.inverse * c, found = a(c);
    EXPECT_LT((found - expected).norm(), (single ? 1e-4 : 1e-9) * expected.norm());
    b(first);
    EXPECT_TRUE((found.array() == b(c).array()).all()) << "the bits depend on threads or earlier calls";
    EXPECT_EQ(a(SparseMatrix(graph.size(), 0)).size(), 0);
  }
}

TEST(InverseProducts, AgreeWithADenseInverse) {
  const support::Graph tube = support::surface(support::Surface::Tube, 12, 20);
  expect_products(tube, {});
  expect_products(tube, {30, 77, 78, 113});
}

TEST(InverseProducts, KnowLongRows) {
  support::Graph wheel =
      together(support::surface(support::Surface::Tube, kLongRow + 100, 1), support::lone_vertices(1));
  for (int v = 0; v + 1 < wheel.size(); ++v) {
    wheel.edges.emplace_back(v, wheel.size() - 1);
  }
  expect_products(wheel, {30, 77});
}

}  // namespace
}  // namespace lapedit::inverse_products_test
