// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/linear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "linear/operators.h"

namespace lapedit {
namespace {

IndexLists graph_of(const TriangleMesh& mesh) {
  return support::adjacency_of(mesh).neighbours;
}

/// Vertices without faces, before, between and behind.
TriangleMesh with_lone_vertices(const TriangleMesh& mesh, int count) {
  TriangleMesh result = mesh;
  const auto n = static_cast<int>(mesh.vertices.rows());
  result.vertices.setZero(n + count, 3);
  result.vertices.topRows(n) = mesh.vertices;
  std::vector<int> numbers = support::shuffled(n + count, 2);
  std::swap(numbers[n], *std::find(numbers.begin(), numbers.end(), 0));  // the first is one of them
  return support::renumbered(result, numbers, 3);
}

struct Shape {
  const char* name;
  TriangleMesh mesh;
};

/// All of them large enough to be given an order: some 30,000 vertices.
const std::vector<Shape>& large_shapes() {
  static const std::vector<Shape> all = [] {
    const TriangleMesh sphere = shapes::icosphere(6), small = shapes::icosphere(1), bar = shapes::bar(60, 40, 20);
    const TriangleMesh pair = shapes::together(shapes::tapered_arm(120, 170), bar, {0, 0, 90});
    return std::vector<Shape>{{"grid", shapes::grid(170, 180)},
                              {"sphere, renumbered", support::renumbered(sphere, support::shuffled(40962, 1), 1)},
                              {"strip", shapes::grid(2, 15000)},
                              {"components", shapes::together(small, pair, {99, 9, 9})},
                              {"lone vertices", with_lone_vertices(shapes::letter_field(180, 160), 1500)},
                              {"nothing but lone vertices", {Points::Zero(30000, 3), Faces(0, 3)}},
                              {"non-manifold", shapes::non_manifold_grid(171, 175)}};
  }();
  return all;
}

/// Fails if small graphs are given an order, which costs more than it gains.
TEST(EliminationOrder, SmallGraphsNeedNone) {
  EXPECT_TRUE(fill_reducing_ordering(IndexLists(), 1).empty());
  EXPECT_TRUE(fill_reducing_ordering(graph_of(shapes::grid(1, 1)), 1).empty());
  EXPECT_TRUE(fill_reducing_ordering(graph_of(shapes::grid(30, 40)), 1).empty());
  EXPECT_TRUE(fill_reducing_ordering(graph_of(shapes::two_pieces(3)), 2).empty());
  EXPECT_FALSE(fill_reducing_ordering(graph_of(shapes::grid(250, 200)), 1).empty());
}

/// Fails if a vertex is missing or named twice, above all one that no edge leads to.
TEST(EliminationOrder, IsAPermutation) {
  for (const Shape& shape : large_shapes()) {
    std::vector<int> order = fill_reducing_ordering(graph_of(shape.mesh), 1);
    std::sort(order.begin(), order.end());
    std::vector<int> all(shape.mesh.vertices.rows());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_TRUE(order == all) << shape.name << ": " << order.size() << " of " << all.size();
  }
}

/// Fails if threads, what was ordered before, or where the graph's lists stand in memory enters.
TEST(EliminationOrder, DependsOnTheGraphAlone) {
  for (const Shape& shape : large_shapes()) {
    const IndexLists graph = graph_of(shape.mesh);
    const std::vector<int> order = fill_reducing_ordering(graph, 1);
    for (const int threads : {2, 3}) {
      const IndexLists copy = graph;
      ASSERT_TRUE(fill_reducing_ordering(copy, threads) == order) << shape.name << ", " << threads << " threads";
    }
  }
}

/// The lower half of M^T M + 1/100, M the umbrella operator.
SparseMatrix system_of(const TriangleMesh& mesh) {
  const SparseMatrix m = support::laplacian(mesh).matrix;
  SparseMatrix identity(m.rows(), m.cols());
  identity.setIdentity();
  const SparseMatrix whole = SparseMatrix(m.transpose()) * m + 0.01 * identity;
  return whole.triangularView<Eigen::Lower>();
}

/// Fails if the order is one that fills the factor: it is there for no other reason. On a narrow limb, where minimum
/// degree is at its best, it is 11 % worse.
TEST(EliminationOrder, FillsHardlyMoreThanMinimumDegreeOrLess) {
  const auto fill_over_minimum_degree = [](const TriangleMesh& mesh) {
    const SparseMatrix system = system_of(mesh);
    CholeskyOptions options;
    options.single_precision = true;
    const auto by_degree = static_cast<double>(SparseCholesky(system, options).factor_nonzeros());
    options.order = fill_reducing_ordering(graph_of(mesh), 1);
    return static_cast<double>(SparseCholesky(system, options).factor_nonzeros()) / by_degree;
  };
  EXPECT_LT(fill_over_minimum_degree(shapes::grid(180, 170)), 1);
  EXPECT_LT(fill_over_minimum_degree(shapes::tapered_arm(120, 260)), 1.2);
}

/// Fails if the factorisation ignores an order, reads it the other way round, or hands it back wrong.
TEST(EliminationOrder, IsTheOneTheFactorHas) {
  constexpr int kSize = 300;
  // A star: eliminating its centre first fills the whole factor, eliminating it last fills nothing.
  SparseMatrix star(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    star.insert(i, i) = i == 5 ? kSize : 2 + 0.01 * i;
    star.coeffRef(std::max(i, 5), std::min(i, 5)) += i == 5 ? 0 : -0.5;
  }
  star.makeCompressed();
  std::mt19937 random(6);
  const Points expected = Points::NullaryExpr(kSize, 3, [&] { return random() / 2147483648.0 - 1; });
  const Points right = star.selfadjointView<Eigen::Lower>() * expected;
  std::vector<int> all = support::shuffled(kSize, 8), good = all;
  std::swap(good.back(), *std::find(good.begin(), good.end(), 5));
  const std::vector<int> bad(good.rbegin(), good.rend());
  std::sort(all.begin(), all.end());
  for (const CholeskyBackend backend : {CholeskyBackend::Supernodal, CholeskyBackend::Eigen}) {
    for (const bool single : {false, true}) {
      for (const std::vector<int>& order : {bad, good, std::vector<int>()}) {
        CholeskyOptions options;
        options.backend = backend;
        options.single_precision = single;
        options.order = order;
        SparseCholesky factor(star, options);
        EXPECT_EQ(factor.factor_nonzeros() > kSize * (kSize - 2) / 2U, order == bad) << factor.backend_name();
        Points x;
        factor.solve(right, x);
        EXPECT_LT((x - expected).norm(), (factor.single_precision() ? 1e-5 : 1e-13) * expected.norm());
        std::vector<int> back = factor.order();
        EXPECT_TRUE(backend != CholeskyBackend::Eigen || order.empty() || back == order);
        std::sort(back.begin(), back.end());
        EXPECT_EQ(back, all) << factor.backend_name();
      }
    }
  }
}

}  // namespace
}  // namespace lapedit
