// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/mesh/vertex_set.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::free_end_test {
namespace {

/// The rotation that fits best between two poses of the vertices that lie in a stretch of the limb.
Matrix3 rotation_of(const Points& before, const Points& after, double from, double to) {
  std::vector<int> inside;
  for (int i = 0; i < static_cast<int>(before.rows()); ++i) {
    if (before(i, 0) >= from && before(i, 0) <= to) {
      inside.push_back(i);
    }
  }
  const Points a = support::rows(before, inside), b = support::rows(after, inside);
  return nearest_rotation((b.rowwise() - b.colwise().mean()).transpose() * (a.rowwise() - a.colwise().mean()));
}

double degrees_between(const Matrix3& a, const Matrix3& b) {
  return support::largest_angle({a}, {b}) * 180 / std::acos(-1.0);
}

/// A limb of length 10, held at its root, grabbed by a disc in its middle: 3.5 of it beyond are held by nothing.
/// Dragged in any direction by up to that length they follow the limb around the handle. Seen: 9 degrees at most.
TEST(FreeEnd, RotatesWithTheHandlesSurroundings) {
  constexpr double kAt = 6.5, kFree = 3.5, kBound = 15;
  const TriangleMesh mesh = shapes::tapered_arm(32, 110);
  const Adjacency adjacency = support::adjacency_of(mesh);
  const int middle = support::vertex_at(mesh, {kAt, 0, 1});
  double largest = 0;
  for (const double radius : {5.0, 7.0}) {
    const Region region = build_region(mesh, adjacency, support::within(radius),
                                       {vertices_within(mesh, adjacency, middle, 0.18 * radius)});
    const Points rest = support::rows(mesh.vertices, region.mesh_vertex);
    for (int i = 0; i < region.size(); ++i) {
      ASSERT_FALSE(region.classes[i] == VertexClass::Anchor && rest(i, 0) > kAt) << "the end is not free";
    }
    support::Prepared solver(mesh, region, EditSettings());
    for (const Vector3& direction : {Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(0, 0, -1), Vector3(1, 0, 0),
                                     Vector3(-0.5, 0, 0), Vector3(0.5, 0, 0.8), Vector3(0, 0.6, -0.8)}) {
      for (const double fraction : {0.25, 0.5, 1.0}) {
        const Points& pose = solver.pose({support::shift(fraction * kFree * direction)});
        const Matrix3 around = rotation_of(rest, pose, kAt - 1, kAt + 1);
        const double tip = degrees_between(rotation_of(rest, pose, 8.5, 11), around);
        const double between = degrees_between(rotation_of(rest, pose, kAt + 1, 8.5), around);
        largest = std::max({largest, tip, between});
        const std::string where = ::testing::PrintToString(direction.transpose()) + " by " + std::to_string(fraction);
        EXPECT_LT(std::max(tip, between), kBound) << where;
        const EditReport report = solver.report();
        EXPECT_EQ(report.flipped, 0) << where;
        EXPECT_EQ(report.folded, 0) << where;
        // It does not fall behind: its tip goes as far as the handle but for a third.
        EXPECT_GT((pose.bottomRows(1) - rest.bottomRows(1)).norm(), 0.66 * fraction * kFree * direction.norm())
            << where;
      }
    }
  }
  RecordProperty("largest_degrees", std::to_string(largest));
}

}  // namespace
}  // namespace lapedit::free_end_test
