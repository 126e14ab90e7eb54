// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lapedit/mesh/weld.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::vertex_set_test {
namespace {

using Set = std::vector<int>;

const TriangleMesh kGrid = shapes::grid(20, 20);
const Adjacency kAround = support::adjacency_of(kGrid);

Set square(int from, int to) {
  Set set;
  for (int i = from; i <= to; ++i) {
    for (int j = from; j <= to; ++j) {
      set.push_back(20 * i + j);
    }
  }
  return set;
}

TEST(VertexSet, GrowsByItsNeighbours) {
  Set ring(kAround.neighbours[210].begin(), kAround.neighbours[210].end());
  EXPECT_EQ(grown(kAround, {210}), united(ring, {210}));
  EXPECT_EQ(grown(kAround, {}), Set());
}

TEST(VertexSet, BorderOfTheMeshIsNoOutside) {
  const Set all = square(0, 19);
  EXPECT_EQ(shrunk(kAround, all, {}), all);
  EXPECT_EQ(grown(kAround, all), all);
}

TEST(VertexSet, ShrinkingKeepsTheGivenVertices) {
  EXPECT_EQ(shrunk(kAround, square(6, 7), {}), Set());
  EXPECT_EQ(shrunk(kAround, square(6, 7), {6 * 20 + 7, 300}), Set{6 * 20 + 7});
}

TEST(VertexSet, WithinARadius) {
  EXPECT_EQ(vertices_within(kGrid, kAround, 210, 0), Set{210});
  EXPECT_EQ(vertices_within(kGrid, kAround, 210, 1), (Set{190, 209, 210, 211, 230}));
  EXPECT_EQ(vertices_within(kGrid, kAround, 210, 100).size(), 400U);
}

TEST(VertexSet, BadArgumentsAreRefused) {
  using support::expect_refusal;
  for (const int vertex : {-1, 400}) {
    expect_refusal(ErrorCause::BadIndex, [=] { vertices_within(kGrid, kAround, vertex, 1); });
  }
  for (const double radius : {-1.0, kUnreached, std::numeric_limits<double>::quiet_NaN()}) {
    expect_refusal(ErrorCause::BadParameter, [=] { vertices_within(kGrid, kAround, 0, radius); });
  }
}

TEST(ShortestPath, IsAsLongAsTheDistance) {
  const TriangleMesh mesh = shapes::letter_field(30, 15);
  const Adjacency around = support::adjacency_of(mesh);
  GeodesicSearch search({around.neighbours, mesh.vertices});
  search.run({7}, kUnreached);
  for (const int to : {7, 8, 200, 449}) {
    const Set path = shortest_path(mesh, around, 7, to);
    ASSERT_FALSE(path.empty());
    EXPECT_EQ(path.front(), 7);
    EXPECT_EQ(path.back(), to);
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const CompressedRows::Row ring = around.neighbours[path[i - 1]];
      EXPECT_TRUE(std::find(ring.begin(), ring.end(), path[i]) != ring.end());
      length += (mesh.vertices.row(path[i]) - mesh.vertices.row(path[i - 1])).norm();
    }
    EXPECT_NEAR(length, search.distance(to), 1e-12);
  }
}

TEST(ShortestPath, GoesAroundWhatIsNotFinite) {
  TriangleMesh mesh = kGrid;
  for (int j = 0; j < 19; ++j) {
    mesh.vertices(20 * 10 + j, 1) = std::numeric_limits<double>::quiet_NaN();
  }
  const Set path = shortest_path(mesh, kAround, 0, 399);
  EXPECT_TRUE(std::find(path.begin(), path.end(), 20 * 10 + 19) != path.end());
  mesh.vertices(20 * 10 + 19, 1) = kUnreached;
  EXPECT_TRUE(shortest_path(mesh, kAround, 0, 399).empty());
}

TriangleMesh grid_with_four_rows_in_one_point() {
  TriangleMesh mesh = shapes::grid(6, 6);
  mesh.vertices.middleRows(6, 24).rowwise() = mesh.vertices.row(10).eval();
  return mesh;
}

TEST(VertexSet, WithinNoRadiusIsOneVertexEvenIfOthersAreAtItsPosition) {
  const TriangleMesh mesh = grid_with_four_rows_in_one_point();
  EXPECT_EQ(vertices_within(mesh, support::adjacency_of(mesh), 14, 0), Set{14});
}

TEST(ShortestPath, EndsWhereEdgesHaveNoLength) {
  const TriangleMesh mesh = grid_with_four_rows_in_one_point();
  for (const auto& [from, to] : {std::pair(0, 35), std::pair(35, 0), std::pair(14, 20)}) {
    const Set path = shortest_path(mesh, support::adjacency_of(mesh), from, to);
    ASSERT_GE(path.size(), 2U);
    EXPECT_EQ(path.front(), from);
    EXPECT_EQ(path.back(), to);
    Set once = path;
    std::sort(once.begin(), once.end());
    EXPECT_EQ(std::adjacent_find(once.begin(), once.end()), once.end());
  }
}

TEST(ShortestPath, IsEmptyBetweenPieces) {
  const TriangleMesh mesh = shapes::two_pieces(1);
  EXPECT_TRUE(shortest_path(mesh, support::adjacency_of(mesh), 0, static_cast<int>(mesh.vertices.rows()) - 1).empty());
}

TEST(Weld, NamesTheFirstOfEachPlace) {
  const double nan = std::nan(""), far = std::numeric_limits<double>::infinity();
  Points points(10, 3);
  points << 0, 0, 0, 1, 0, 0, -0.0, 0, -0.0, 1, 0, 0, 1, 1e-300, 0, nan, 0, 0, nan, 0, 0, 1, 0, 0, 0, far, 0, 0, far, 0;
  const Weld weld(points);
  ASSERT_FALSE(weld.empty());
  const std::vector<int> first = {0, 1, 0, 1, 4, 5, 6, 1, 8, 9};
  for (int v = 0; v < 10; ++v) {
    EXPECT_EQ(weld.representative(v), first[static_cast<std::size_t>(v)]) << v;
  }
  std::vector<int> vertices = {1, 4}, rows;
  weld.add_others(vertices, rows);
  EXPECT_EQ(vertices, (std::vector<int>{1, 3, 4, 7}));
  EXPECT_EQ(rows, (std::vector<int>{0, 0, 1, 0}));
  Points positions(4, 3);
  positions << 1, 1, 1, 1, 1, 1, 4, 4, 4, 1, 1, 1;
  const Points before = positions;
  weld.add_others(vertices, positions);
  EXPECT_EQ(positions, before) << "they are there already";
  EXPECT_TRUE(Weld(shapes::icosphere(2).vertices).empty());
}

}  // namespace
}  // namespace lapedit::vertex_set_test
