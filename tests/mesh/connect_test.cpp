// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/connect.h"

#include <gtest/gtest.h>

#include "shapes.h"
#include "support.h"

namespace lapedit::connect_test {
namespace {

/// A ball of 642 vertices, and a smaller, coarser one of 42 inside it, 0.1 away.
TriangleMesh ball_in_ball() {
  TriangleMesh inner = shapes::icosphere(1);
  inner.vertices *= 0.9;
  return shapes::together(shapes::icosphere(3), inner, Vector3::Zero());
}

std::vector<std::pair<int, int>> links_of(const IndexLists& before, const IndexLists& after) {
  std::vector<std::pair<int, int>> links;
  for (int v = 0; v < before.rows(); ++v) {
    for (const int w : after[v]) {
      if (!std::binary_search(before[v].begin(), before[v].end(), w)) {
        links.emplace_back(v, w);
      }
    }
  }
  return links;
}

TEST(Connect, LinksNearestVerticesOfDifferentPiecesWithinTheGap) {
  const TriangleMesh mesh = ball_in_ball();
  const Adjacency adjacency = support::adjacency_of(mesh);
  const IndexLists linked = linked_neighbours(mesh, adjacency.neighbours, 0.2);
  const auto links = links_of(adjacency.neighbours, linked);
  std::vector<int> count(mesh.vertices.rows(), 0);
  for (const auto& [v, w] : links) {
    EXPECT_NE(v < 642, w < 642) << "within a piece";
    EXPECT_LE((mesh.vertices.row(v) - mesh.vertices.row(w)).norm(), 0.2);
    const auto back = linked[w];
    EXPECT_TRUE(std::binary_search(back.begin(), back.end(), v));
    ++count[v];
  }
  for (int v = 642; v < mesh.vertices.rows(); ++v) {
    EXPECT_GE(count[v], 1) << "each of the inner ball's has a vertex outside it";
    EXPECT_LE(count[v], kMostLinks + 1) << "however many of the outer ball's are nearest to it";
  }
  for (int v = 0; v < linked.rows(); ++v) {
    EXPECT_TRUE(std::is_sorted(linked[v].begin(), linked[v].end()));
    for (const int w : adjacency.neighbours[v]) {
      EXPECT_TRUE(std::binary_search(linked[v].begin(), linked[v].end(), w));
    }
  }
  EXPECT_TRUE(links_of(adjacency.neighbours, linked_neighbours(mesh, adjacency.neighbours, 0.01)).empty());
  std::vector<int> labels;
  EXPECT_EQ(connected_components(linked, labels), 1);
}

TEST(Connect, RegionGoesOnIntoThePieceThatIsNear) {
  const TriangleMesh mesh = ball_in_ball();
  const Adjacency adjacency = support::adjacency_of(mesh);
  RegionSpec spec = support::within(1.2);
  const int pole = support::vertex_at(mesh, {0, 0, 1});
  const Region apart = build_region(mesh, adjacency, spec, {{pole}});
  EXPECT_TRUE(apart.links.empty());
  EXPECT_LT(apart.mesh_vertex.back(), 642);
  spec.connect_gap = 0.2;
  const Region region = build_region(mesh, adjacency, spec, {{pole}});
  EXPECT_GT(region.links.size(), 10U);
  EXPECT_GE(region.mesh_vertex.back(), 642);
  EXPECT_EQ(region.anchored.size(), 1U) << "one component";
  for (const auto& [i, j] : region.links) {
    EXPECT_TRUE(region.mesh_vertex[i] < 642 && region.mesh_vertex[j] >= 642);
  }
  for (const auto& face : region.faces.rowwise()) {
    EXPECT_EQ(region.mesh_vertex[face[0]] < 642, region.mesh_vertex[face[1]] < 642);
  }
}

/// What is linked but not in a given set does not hold it.
TEST(Connect, LinksOutOfAGivenSetMakeNoRim) {
  const TriangleMesh mesh = ball_in_ball();
  const Adjacency adjacency = support::adjacency_of(mesh);
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.connect_gap = 0.2;
  spec.vertices.resize(642);
  std::iota(spec.vertices.begin(), spec.vertices.end(), 0);
  EXPECT_EQ(build_region(mesh, adjacency, spec, {{5}}).count(VertexClass::Anchor), 0);
}

TEST(Connect, GapThatIsNoLengthIsRefused) {
  const TriangleMesh mesh = ball_in_ball();
  const Adjacency adjacency = support::adjacency_of(mesh);
  RegionSpec spec = support::within(1);
  for (const double gap : {-0.1, kUnreached, std::nan("")}) {
    spec.connect_gap = gap;
    support::expect_refusal(ErrorCause::BadParameter, [&] { build_region(mesh, adjacency, spec, {{5}}); });
  }
}

}  // namespace
}  // namespace lapedit::connect_test
