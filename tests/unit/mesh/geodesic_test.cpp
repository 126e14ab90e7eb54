// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

#include "support.h"

namespace lapedit::geodesic_test {
namespace {

/// Distances of all vertices along edges after one search.
std::vector<double> distances(const TriangleMesh& mesh, const std::vector<int>& seeds,
                              const std::vector<char>* allowed = nullptr) {
  const Adjacency adjacency = support::adjacency_of(mesh);
  GeodesicSearch search({adjacency.neighbours, mesh.vertices});
  search.run(seeds, kUnreached, allowed);
  std::vector<double> result(mesh.vertices.rows());
  for (int v = 0; v < static_cast<int>(result.size()); ++v) {
    result[v] = search.distance(v);
  }
  return result;
}

TEST(Geodesic, EqualsTryingAllEdgesAndLines) {
  for (const TriangleMesh& mesh : support::all_shapes()) {
    support::expect_plain_distances(mesh, false);
    support::expect_plain_distances(mesh, true);
  }
}

TEST(Geodesic, CutoffReachesExactlyWhatIsNotFartherNearestFirstThenByNumber) {
  for (const TriangleMesh& mesh : support::all_shapes()) {
    const Adjacency adjacency = support::adjacency_of(mesh);
    const std::vector<double> all = distances(mesh, {20, 3});
    for (const double cutoff : {all[mesh.vertices.rows() / 2 - 1], kUnreached}) {  // a vertex lies exactly on it
      GeodesicSearch search({adjacency.neighbours, mesh.vertices});
      const std::vector<int>& reached = search.run({20, 3}, cutoff);
      int near = 0;
      for (std::size_t v = 0; v < all.size(); ++v) {
        const bool is_near = all[v] <= cutoff && all[v] < kUnreached;
        near += is_near;
        EXPECT_EQ(search.distance(v), is_near ? all[v] : kUnreached) << "vertex " << v;
      }
      ASSERT_EQ(static_cast<int>(reached.size()), near);
      for (std::size_t k = 1; k < reached.size(); ++k) {
        EXPECT_LT(std::pair(all[reached[k - 1]], reached[k - 1]), std::pair(all[reached[k]], reached[k]));
      }
    }
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
  const std::vector<double> found = distances(mesh, {0}, &allowed);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(found[10 + j], kUnreached);
  }
  EXPECT_DOUBLE_EQ(found[20], 8 + 2 * std::sqrt(2.0));
}

/// Three equilateral triangles at one edge, and faces that name a corner twice, which are none.
TEST(Geodesic, LinesCrossAnEdgeOfThreeFaces) {
  const double height = std::sqrt(0.75);
  TriangleMesh mesh = support::mesh_of({0, 0, 0, 1, 0, 0, 0.5, height, 0, 0.5, 0, height, 0.5, -height, 0},
                                       {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 0, 1, 3, 2, 2});
  const Adjacency adjacency = support::adjacency_of(mesh);
  GeodesicSearch search({mesh, adjacency});
  search.run({2}, kUnreached);
  EXPECT_NEAR(search.distance(4), 2 * height, 1e-12);
}

/// Two triangles with a long common edge: the vertices opposite to each other are near, the edge's ends are far.
TriangleMesh bow_tie() {
  TriangleMesh mesh =
      support::mesh_of({0, 0, 0, 0.5, 2, 0, 0.5, -2, 0, 1, 0, 0, -0.4, 0, 0}, {0, 2, 1, 1, 2, 3, 0, 1, 4, 0, 4, 2});
  return mesh;
}

TEST(Geodesic, VertexWithoutNeighboursInTheRadiusIsNotReached) {
  const TriangleMesh mesh = bow_tie();
  const Adjacency adjacency = support::adjacency_of(mesh);
  EXPECT_EQ(vertices_within(mesh, adjacency, 0, 1.2), (std::vector<int>{0, 4}));
  EXPECT_EQ(support::region_of(mesh, support::within(1.2), {{0}}).mesh_vertex, (std::vector<int>{0, 4}));
  // With a neighbour it belongs to it, at its distance across the edge.
  const Region region = support::region_of(mesh, support::within(2.1), {{0}});
  EXPECT_EQ(region.mesh_vertex, (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(region.distance[3], 1);
}

TEST(Geodesic, LinesKeepToAllowedVertices) {
  const TriangleMesh mesh = bow_tie();
  const Adjacency adjacency = support::adjacency_of(mesh);
  const std::vector<char> allowed{1, 0, 1, 1, 1};
  GeodesicSearch search({mesh, adjacency});
  search.run({0}, kUnreached, &allowed);
  EXPECT_DOUBLE_EQ(search.distance(3), 2 * std::hypot(0.5, 2));
}

}  // namespace
}  // namespace lapedit::geodesic_test
