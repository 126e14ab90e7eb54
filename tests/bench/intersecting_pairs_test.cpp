// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/intersecting_pairs.h"

#include <gtest/gtest.h>

#include <numeric>

#include "shapes.h"
#include "support.h"

namespace quality {
namespace {

using Pairs = std::vector<std::pair<int, int>>;
using lapedit::TriangleMesh;
using lapedit::Vector3;
namespace shapes = lapedit::shapes;
namespace support = lapedit::support;

Pairs all_pairs(const TriangleMesh& mesh) {
  std::vector<int> faces(mesh.faces.rows());
  std::iota(faces.begin(), faces.end(), 0);
  return intersecting_pairs(mesh.faces, faces, mesh.vertices);
}

TEST(IntersectingPairs, NoneOnWhatIsWhole) {
  for (const TriangleMesh& mesh :
       {shapes::icosphere(2), shapes::grid(7, 5), shapes::non_manifold_grid(7, 5), shapes::tapered_arm(16, 20)}) {
    EXPECT_EQ(all_pairs(mesh), Pairs());
  }
}

TEST(IntersectingPairs, SheetsThatCross) {
  // Two triangles that meet in the middle, and a third apart.
  TriangleMesh mesh;
  mesh.vertices.resize(9, 3);
  mesh.vertices << -2, -1, 0, 2, -1, 0, 0, 2, 0, 0, 0, -1, 0.5, 0, 1, -0.5, 0, 1, 0, 0, 5, 1, 0, 5, 0, 1, 5;
  mesh.faces.resize(3, 3);
  mesh.faces << 0, 1, 2, 3, 4, 5, 6, 7, 8;
  EXPECT_EQ(all_pairs(mesh), (Pairs{{0, 1}}));
  EXPECT_EQ(intersecting_pairs(mesh.faces, {1}, mesh.vertices), (Pairs{{0, 1}})) << "one of the two is looked at";
  EXPECT_EQ(intersecting_pairs(mesh.faces, {2}, mesh.vertices), Pairs());

  const TriangleMesh sheet = shapes::grid(5, 5);
  const TriangleMesh upright{support::moved(support::rigid(90, Vector3(0, 1, 0), Vector3(1.7, 0.3, 2)), sheet.vertices),
                             sheet.faces};
  const TriangleMesh both = shapes::together(sheet, upright, Vector3::Zero());
  const int found = static_cast<int>(all_pairs(both).size());
  EXPECT_GE(found, 16);
  TriangleMesh apart = both;
  apart.vertices.bottomRows(25).col(2).array() += 10;
  EXPECT_EQ(new_pairs(all_pairs(apart), all_pairs(both)), found);
  EXPECT_EQ(new_pairs(all_pairs(both), all_pairs(both)), 0);
}

TEST(IntersectingPairs, NeighboursThatFold) {
  TriangleMesh mesh;
  mesh.faces.resize(2, 3);
  mesh.vertices.resize(4, 3);
  mesh.faces << 0, 1, 2, 1, 0, 3;
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 0.7, 0;
  EXPECT_EQ(all_pairs(mesh).size(), 1U) << "onto each other, over a common side";
  mesh.vertices(3, 1) = -0.7;
  EXPECT_EQ(all_pairs(mesh).size(), 0U);

  mesh.vertices.resize(5, 3);
  mesh.faces << 0, 1, 2, 0, 3, 4;
  mesh.vertices << 0, 0, 0, 2, -1, 0, 2, 1, 0, 1, 0, -1, 1, 0, 1;
  EXPECT_EQ(all_pairs(mesh).size(), 1U) << "through each other, from a common corner";
  mesh.vertices.bottomRows(2).col(0) *= -1;
  EXPECT_EQ(all_pairs(mesh).size(), 0U);
}

TEST(IntersectingPairs, DegenerateFacesAreLeftOut) {
  EXPECT_NO_THROW(all_pairs(shapes::degenerate_grid(12, 9)));
}

}  // namespace
}  // namespace quality
