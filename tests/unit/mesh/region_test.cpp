// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/region.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <tuple>
#include <vector>

#include "shapes.h"
#include "support.h"

namespace lapedit::region_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Groups = std::vector<std::vector<int>>;
using support::component;
using support::given;
using support::within;

Region build(const TriangleMesh& mesh, const RegionSpec& spec, const Groups& groups) {
  return support::region_of(mesh, spec, groups);
}

std::vector<int> block(int columns, int first_row, int last_row, int first_column, int last_column) {
  std::vector<int> vertices;
  for (int i = first_row; i <= last_row; ++i) {
    for (int j = first_column; j <= last_column; ++j) {
      vertices.push_back(columns * i + j);
    }
  }
  return vertices;
}

/// Mesh vertices of one class.
std::set<int> members(const Region& region, VertexClass wanted) {
  std::set<int> result;
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == wanted) {
      result.insert(region.mesh_vertex[i]);
    }
  }
  return result;
}

/// Region vertices with a mesh neighbour outside, from the faces alone.
std::set<int> boundary_of(const TriangleMesh& mesh, const Region& region) {
  const std::set<int> inside(region.mesh_vertex.begin(), region.mesh_vertex.end());
  std::set<int> boundary;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 9; ++k) {
      const int a = mesh.faces(f, k % 3), b = mesh.faces(f, k / 3);
      if (inside.count(a) && !inside.count(b)) {
        boundary.insert(a);
      }
    }
  }
  return boundary;
}

TEST(Region, RadiusTakesExactlyWhatIsWithinIt) {
  const std::tuple<TriangleMesh, Groups, double> cases[] = {
      {shapes::letter_field(30, 20), {{310}}, 0.9},
      {shapes::letter_field(30, 20), {{310, 311, 331}, {250}}, 0.6},
      {shapes::icosphere(3), {{100}, {3}}, 0.7},
      {shapes::bar(9, 3, 3), {{0, 1}}, 5.5},
      {shapes::tapered_arm(16, 40), {{641}}, 4.0},
      {shapes::degenerate_grid(14, 11), {{60}}, 4.0},
      {shapes::non_manifold_grid(14, 11), {{60, 61}}, 3.2},
      {shapes::inconsistent_grid(14, 11), {{70}}, 3.5},
      {shapes::two_pieces(2), {{5}, {200}}, 1.0}};
  for (const auto& [mesh, groups, radius] : cases) {
    std::vector<int> seeds;
    for (const auto& group : groups) {
      seeds.insert(seeds.end(), group.begin(), group.end());
    }
    const std::vector<double> distance = support::plain_distances(mesh, seeds);
    for (const double padding : {0.0, 0.1, 0.5, 1.0}) {
      const Region region = build(mesh, within(radius, padding), groups);
      EXPECT_EQ(region.radius, radius);
      EXPECT_EQ(region.left_out, 0);
      EXPECT_EQ(region.mesh_vertex,
                support::where(mesh.vertices.rows(), [&, &r = radius](int v) { return distance[v] <= r; }));
      const std::set<int> boundary = boundary_of(mesh, region);
      for (int i = 0; i < region.size(); ++i) {
        const int v = region.mesh_vertex[i];
        EXPECT_NEAR(region.distance[i], distance[v], 1e-14 * radius);
        if (region.group[i] < 0) {
          const bool band = distance[v] > (1 - padding) * radius * (1 + 1e-14);
          EXPECT_EQ(region.classes[i], band || boundary.count(v) ? VertexClass::Anchor : VertexClass::Free)
              << "vertex " << v << ", padding " << padding;
        }
      }
    }
  }
}

TEST(Region, BorderOfTheMeshIsNoBoundary) {
  const TriangleMesh mesh = shapes::grid(9, 9);
  const Region region = build(mesh, within(100, 0), {{40}});
  EXPECT_EQ(region.size(), 81);
  EXPECT_EQ(region.count(VertexClass::Anchor), 0);
  // A block in a corner of the mesh: its two sides inside the mesh are boundary, the two on the border are not.
  const Region corner = build(mesh, given(block(9, 0, 4, 0, 4), 0), {{10}});
  std::set<int> sides;
  for (int k = 0; k <= 4; ++k) {
    sides.insert(9 * 4 + k);
    sides.insert(9 * k + 4);
  }
  EXPECT_EQ(members(corner, VertexClass::Anchor), sides);
}

TEST(Region, AnchorDepthGrowsAcrossTheBand) {
  const TriangleMesh mesh = shapes::grid(31, 31);
  const Region region = build(mesh, within(10, 0.4), {{480}});
  int checked = 0;
  for (int i = 0; i < region.size(); ++i) {
    const int v = region.mesh_vertex[i];
    if (region.classes[i] == VertexClass::Anchor && !boundary_of(mesh, region).count(v)) {
      EXPECT_NEAR(region.anchor_depth[i], (region.distance[i] - 6) / 4, 1e-12);
      ++checked;
    }
  }
  EXPECT_GT(checked, 20);
}

/// The band of a set is as wide as a part of the largest handle distance, measured from the boundary.
TEST(Region, AnchorDepthOfAGivenSetGrowsTowardsItsBoundary) {
  const TriangleMesh mesh = shapes::grid(31, 31);
  const Region region = build(mesh, given(block(31, 3, 27, 3, 27), 0.3), {{15 * 31 + 15}});
  const double width = 0.3 * region.max_distance;
  for (int i = 0; i < region.size(); ++i) {
    const int row = region.mesh_vertex[i] / 31, column = region.mesh_vertex[i] % 31;
    const double depth = 1 - std::min({row - 3, 27 - row, column - 3, 27 - column}) / width;
    EXPECT_NEAR(region.anchor_depth[i], depth > 0 ? depth : 0, 1e-12);
    EXPECT_EQ(region.classes[i] == VertexClass::Anchor, depth > 0);
    EXPECT_NEAR(region.anchor_weight[i], depth > 0 ? region.distance[i] / region.max_distance : 0, 1e-12);
  }
}

TEST(Region, HandleOnTheBoundaryStaysAHandle) {
  const TriangleMesh mesh = shapes::grid(9, 9);
  const Region region = build(mesh, given(block(9, 2, 6, 2, 6), 0.5), {{20, 21}});  // a corner of the block
  EXPECT_EQ(members(region, VertexClass::Handle), (std::set<int>{20, 21}));
}

TEST(Region, KeptAnchorsReplaceTheBand) {
  const TriangleMesh mesh = shapes::grid(40, 40);
  const Adjacency adjacency = support::adjacency_of(mesh);
  const Region first = build_region(mesh, adjacency, support::within(12), {{820}});
  RegionSpec next = given(first.mesh_vertex);
  next.anchors = anchors_of(first);
  const Region second = build_region(mesh, adjacency, next, {{701}});
  ASSERT_EQ(second.mesh_vertex, first.mesh_vertex);
  EXPECT_EQ(second.max_distance, first.max_distance);
  EXPECT_EQ(second.anchor_weight, first.anchor_weight);
  EXPECT_EQ(second.anchor_depth, first.anchor_depth);
  for (int i = 0; i < first.size(); ++i) {
    EXPECT_EQ(second.classes[i] == VertexClass::Anchor, first.classes[i] == VertexClass::Anchor);
    EXPECT_EQ(second.classes[i] == VertexClass::Handle, second.mesh_vertex[i] == 701);
  }
  // A handle among them is a handle, and the boundary is held even where it is not listed.
  const int on_anchor = next.anchors.vertices[3];
  EXPECT_EQ(build_region(mesh, adjacency, next, {{on_anchor}}).count(VertexClass::Anchor),
            first.count(VertexClass::Anchor) - 1);
  next.anchors.vertices.resize(1);
  next.anchors.weights.resize(1);
  next.anchors.depths.resize(1);
  EXPECT_GT(build_region(mesh, adjacency, next, {{820}}).count(VertexClass::Anchor), 40);
}

TEST(Region, ComponentOfAGivenSetWithoutHandleIsLeftOut) {
  const TriangleMesh mesh = shapes::grid(20, 9);
  std::vector<int> set = block(9, 1, 7, 1, 7);
  const std::vector<int> apart = block(9, 12, 15, 2, 6);
  set.insert(set.end(), apart.begin(), apart.end());
  const Region region = build(mesh, given(set), {{40}});
  EXPECT_EQ(region.size(), 49);
  EXPECT_EQ(region.left_out, 20);
  EXPECT_LT(region.mesh_vertex.back(), 9 * 8);
}

TEST(Region, DistanceDoesNotLeaveAGivenSet) {
  const TriangleMesh mesh = shapes::grid(5, 5);
  const Region region = build(mesh, given({0, 1, 2, 3, 4, 9, 14, 19, 24, 23, 22, 21, 20}), {{0}});  // a bent strip
  EXPECT_DOUBLE_EQ(region.max_distance, 10 + std::sqrt(2.0));
}

/// tests/cli/edits_test.py has what JSON can say.
TEST(Region, WrongNumbersAndEmptyGroupsAreRefused) {
  const TriangleMesh mesh = shapes::grid(9, 9);
  for (const RegionSpec& spec : {within(kNaN), within(kInfinity), given(block(9, 2, 6, 2, 6), kNaN)}) {
    support::expect_refusal(ErrorCause::BadParameter, [&] { build(mesh, spec, {{40}}); });
  }
  support::expect_refusal(ErrorCause::NoHandle, [&] { build(mesh, within(3), {}); });
  support::expect_refusal(ErrorCause::NoHandle, [&] { build(mesh, within(3), {{40}, {}}); });
  for (const int bad : {-1, 81}) {
    support::expect_refusal(ErrorCause::BadIndex, [&] { build(mesh, within(3), {{40, bad}}); });
    support::expect_refusal(ErrorCause::BadIndex, [&] { build(mesh, given({39, 40, 41, bad}), {{40}}); });
    RegionSpec spec = given(block(9, 2, 6, 2, 6));
    spec.anchors = {{30, bad}, {1, 0.9}, {1, 0.5}, 5};
    support::expect_refusal(ErrorCause::BadIndex, [&] { build(mesh, spec, {{40}}); });
  }
  support::expect_refusal(ErrorCause::EmptyRegion, [&] { build(mesh, given({}), {{40}}); });
  RegionSpec spec = given(block(9, 2, 6, 2, 6));
  spec.anchors = {{30, 31}, {1, 0.9}, {1, kNaN}, 5};
  support::expect_refusal(ErrorCause::BadParameter, [&] { build(mesh, spec, {{40}}); });
}

TEST(Region, VertexWithoutFacesIsRefused) {
  const TriangleMesh isolated = shapes::degenerate_grid(12, 9);
  const int last = static_cast<int>(isolated.vertices.rows()) - 1;
  support::expect_refusal(ErrorCause::NothingToFollow, [&] { build(isolated, component(), {{last}}); });
}

TEST(Region, CoordinatesThatAreNotNumbersMatterOnlyInOrNextToTheRegion) {
  for (const double bad : {kNaN, kInfinity}) {
    TriangleMesh mesh = shapes::grid(15, 15);
    mesh.vertices(0, 2) = bad;
    EXPECT_GT(build(mesh, within(3), {{112}}).size(), 1);
    mesh.vertices(112 + 2, 2) = bad;
    const std::string sentence =
        support::expect_refusal(ErrorCause::NotFinite, [&] { build(mesh, within(3), {{112}}); });
    EXPECT_NE(sentence.find("114"), std::string::npos) << sentence;
    support::expect_refusal(ErrorCause::NotFinite, [&] { build(mesh, within(3), {{114}}); });
    support::expect_refusal(ErrorCause::NotFinite, [&] { build(mesh, given(block(15, 5, 9, 5, 9)), {{112}}); });
    support::expect_refusal(ErrorCause::NotFinite, [&] { build(mesh, component(), {{112}}); });
  }
}

/// Large enough for several threads, each with several pieces.
TEST(LargeRegion, ThreadsChangeNoBit) {
  const TriangleMesh letters = shapes::letter_field(190, 130);
  const TriangleMesh sheets =
      shapes::together(shapes::degenerate_grid(150, 130), shapes::non_manifold_grid(60, 50), Vector3(500, 0, 0));
  const auto bits = [](const Region& r) {
    return std::tuple(r.mesh_vertex, r.classes, r.group, r.component, r.anchored, r.distance, r.anchor_weight,
                      r.anchor_depth, r.neighbours.offsets, r.neighbours.values, r.edge_faces, r.max_distance);
  };
  for (const auto& [mesh, groups] : {std::pair(letters, Groups{{70, 71, 200}, {12000}, {20000, 20001, 24000}}),
                                     std::pair(sheets, Groups{{9000, 9001}, {60}}),
                                     std::pair(shapes::grid(150, 150), Groups{{11000, 11001}, {11003}})}) {
    std::vector<int> set = support::where(mesh.vertices.rows(), [](int v) { return v % 37 != 5; });  // with holes
    for (const auto& group : groups) {
      set.insert(set.end(), group.begin(), group.end());
    }
    const double size = support::diameter(mesh.vertices);
    for (const RegionSpec& spec : {within(0.1 * size), within(size), given(set), component()}) {
      const Adjacency adjacency = support::adjacency_of(mesh);
      const auto expected = bits(build_region(mesh, adjacency, spec, groups, 1));
      for (const int threads : {2, 3}) {
        EXPECT_TRUE(bits(build_region(mesh, adjacency, spec, groups, threads)) == expected) << threads;
      }
    }
  }
}

}  // namespace
}  // namespace lapedit::region_test
