// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "shapes.h"
#include "support.h"

namespace lapedit::geodesic_test {
namespace {

/// Distances of all vertices after one search.
std::vector<double> distances(const TriangleMesh& mesh, const std::vector<int>& seeds, double cutoff = kUnreached,
                              const std::vector<char>* allowed = nullptr) {
  const Adjacency adjacency = support::adjacency_of(mesh);
  GeodesicSearch search({adjacency.neighbours, mesh.vertices});
  search.run(seeds, cutoff, allowed);
  std::vector<double> result(mesh.vertices.rows());
  for (int v = 0; v < static_cast<int>(result.size()); ++v) {
    result[v] = search.distance(v);
  }
  return result;
}

class GeodesicOn : public ::testing::TestWithParam<TriangleMesh (*)()> {};
INSTANTIATE_TEST_SUITE_P(Shapes, GeodesicOn,
                         ::testing::Values([] { return shapes::letter_field(24, 16); },
                                           [] { return shapes::icosphere(3); }, [] { return shapes::bar(7, 3, 2); },
                                           [] { return shapes::tapered_arm(12, 30); },
                                           [] { return shapes::degenerate_grid(12, 9); },
                                           [] { return shapes::non_manifold_grid(12, 9); },
                                           [] { return shapes::two_pieces(2); }));

TEST_P(GeodesicOn, EqualsRelaxingAllEdges) {
  const TriangleMesh mesh = GetParam()();
  for (const std::vector<int>& seeds : {std::vector<int>{0}, {3, 40, 41}}) {
    const std::vector<double> found = distances(mesh, seeds);
    const std::vector<double> expected = support::bellman_ford(mesh, seeds);
    for (std::size_t v = 0; v < found.size(); ++v) {
      // The same sums of the same edges along the same path, so the same bits; two paths of equal length up to rounding
      // may swap.
      ASSERT_TRUE(found[v] == expected[v] || std::abs(found[v] - expected[v]) < 1e-12) << "vertex " << v;
    }
  }
}

TEST_P(GeodesicOn, CutoffReachesExactlyWhatIsNotFarther) {
  const TriangleMesh mesh = GetParam()();
  const Adjacency adjacency = support::adjacency_of(mesh);
  const std::vector<double> all = distances(mesh, {11});
  const double cutoff = all[mesh.vertices.rows() / 2 - 1];  // a vertex lies exactly on it
  GeodesicSearch search({adjacency.neighbours, mesh.vertices});
  const std::vector<int>& reached = search.run({11}, cutoff);
  int near = 0;
  for (std::size_t v = 0; v < all.size(); ++v) {
    near += all[v] <= cutoff;
    EXPECT_EQ(search.distance(v), all[v] <= cutoff ? all[v] : kUnreached) << "vertex " << v;
  }
  EXPECT_EQ(static_cast<int>(reached.size()), near);
}

TEST_P(GeodesicOn, ListsReachedVerticesNearestFirstThenByNumber) {
  const TriangleMesh mesh = GetParam()();
  const Adjacency adjacency = support::adjacency_of(mesh);
  GeodesicSearch search({adjacency.neighbours, mesh.vertices});
  const std::vector<int>& reached = search.run({20, 3}, kUnreached);
  ASSERT_GT(reached.size(), 2U);
  for (std::size_t k = 1; k < reached.size(); ++k) {
    const double before = search.distance(reached[k - 1]), here = search.distance(reached[k]);
    EXPECT_TRUE(before < here || (before == here && reached[k - 1] < reached[k])) << "position " << k;
  }
}

TEST(Geodesic, VerticesThatAreNotNumbersAreNotEntered) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TriangleMesh mesh = shapes::grid(5, 5);
    mesh.vertices(12, 1) = bad;
    const std::vector<double> found = distances(mesh, {0});
    EXPECT_EQ(found[12], kUnreached);
    const Adjacency adjacency = support::adjacency_of(mesh);
    GeodesicSearch search({adjacency.neighbours, mesh.vertices});
    EXPECT_EQ(search.run({0}, kUnreached).size(), 24U) << "reached at an infinite distance is entered, too";
    // Where the only shortest way leads through the middle: a wall of such vertices, open at one end.
    for (int j = 0; j < 4; ++j) {
      mesh.vertices(10 + j, 2) = bad;
    }
    // Along the wall, around its end, and back over two diagonals.
    EXPECT_DOUBLE_EQ(distances(mesh, {0})[20], 8 + 2 * std::sqrt(2.0));
    mesh.vertices(14, 0) = bad;
    EXPECT_EQ(distances(mesh, {0})[20], kUnreached);
  }
}

TEST(Geodesic, OnlyAllowedVerticesAreEntered) {
  const TriangleMesh mesh = shapes::grid(5, 5);
  std::vector<char> allowed(25, 1);
  for (int j = 0; j < 4; ++j) {
    allowed[10 + j] = 0;
  }
  const std::vector<double> found = distances(mesh, {0}, kUnreached, &allowed);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(found[10 + j], kUnreached);
  }
  EXPECT_DOUBLE_EQ(found[20], 8 + 2 * std::sqrt(2.0));
}

}  // namespace
}  // namespace lapedit::geodesic_test
