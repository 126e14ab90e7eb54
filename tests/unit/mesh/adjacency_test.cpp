// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/adjacency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "lapedit/mesh/triangle_mesh.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::adjacency_test {
namespace {

/// The faces of a grid but for some squares.
std::vector<unsigned> grid_without(int columns, int rows, const std::vector<std::pair<int, int>>& holes) {
  std::vector<unsigned> corners;
  for (int y = 0; y + 1 < rows; ++y) {
    for (int x = 0; x + 1 < columns; ++x) {
      if (std::find(holes.begin(), holes.end(), std::make_pair(x, y)) == holes.end()) {
        const unsigned a = y * columns + x, b = a + 1, c = a + columns, d = c + 1;
        corners.insert(corners.end(), {a, b, d, a, d, c});
      }
    }
  }
  return corners;
}

/// How often each vertex ends an edge of the chains.
std::map<unsigned, int> degrees(const Chains& chains) {
  std::map<unsigned, int> degree;
  std::size_t at = 0;
  for (const int length : chains.lengths) {
    for (int i = 0; i < length; ++i, ++at) {
      degree[chains.vertices[at]] += i > 0 && i + 1 < length ? 2 : 1;
    }
  }
  EXPECT_EQ(at, chains.vertices.size());
  return degree;
}

TEST(PatchBorder, OfASheetIsOneClosedChainOnce) {
  const Chains border = border_of(grid_without(6, 5, {}));
  ASSERT_EQ(border.lengths, std::vector<int>{2 * (5 + 4) + 1});
  EXPECT_EQ(border.vertices.front(), border.vertices.back());
  for (const auto& [vertex, degree] : degrees(border)) {
    EXPECT_EQ(degree, 2) << vertex;
    EXPECT_TRUE(vertex % 6 == 0 || vertex % 6 == 5 || vertex < 6 || vertex >= 24) << vertex;
  }
}

TEST(PatchBorder, GoesRoundHolesAndThroughTheirCorners) {
  const Chains one = border_of(grid_without(7, 7, {{2, 2}}));
  ASSERT_EQ(one.lengths.size(), 2u);
  EXPECT_EQ(std::min(one.lengths[0], one.lengths[1]), 5);
  // Two holes that share a corner: each edge once, each vertex left as often as it is entered.
  const Chains two = border_of(grid_without(7, 7, {{2, 2}, {3, 3}}));
  int edges = 0;
  for (const int length : two.lengths) {
    edges += length - 1;
  }
  EXPECT_EQ(edges, 24 + 8);
  for (const auto& [vertex, degree] : degrees(two)) {
    EXPECT_EQ(degree, vertex == 3u * 7 + 3 ? 4 : 2);
  }
}

TEST(PatchBorder, OfAClosedSurfaceOrOfNothingIsNothing) {
  EXPECT_TRUE(border_of({}).lengths.empty());
  EXPECT_TRUE(border_of({0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2}).vertices.empty());
  EXPECT_TRUE(border_of({4, 4, 4}).vertices.empty());
}

/// tests/cli/program_test.py has its counts.
TEST(MeshSummary, FacesThatNameNoVertexAreRefused) {
  TriangleMesh mesh = shapes::grid(5, 4);
  mesh.faces(0, 0) = 20;
  support::expect_refusal(ErrorCause::BadIndex, [&] { summary_of(mesh); });
}

}  // namespace
}  // namespace lapedit::adjacency_test
