// SPDX-License-Identifier: GPL-3.0-or-later
// What advice is decided by; tests/cli/edits_test.py has whole edits.
#include <gtest/gtest.h>

#include <vector>

#include "lapedit/mesh/surface_measures.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::advice_test {
namespace {

using support::rigid;

TEST(AdviceOnVolume, ComponentsAreMeasuredOneByOne) {
  const TriangleMesh ball = shapes::icosphere(2);
  const TriangleMesh both = shapes::together(shapes::bar(6, 6, 6), ball, Vector3(20, 0, 0));
  const Region region = support::whole_region(both, {{0}, {218}}, {});
  const std::vector<ComponentVolume> volumes = component_volumes(region, both.vertices);
  ASSERT_EQ(volumes.size(), 2U);
  EXPECT_NEAR(volumes[0].volume, 216, 1e-9);
  EXPECT_NEAR(volumes[1].volume, enclosed_volume(support::whole_region(ball, {{0}}, {}), ball.vertices).volume, 1e-9);
  EXPECT_TRUE(volumes[0].is_body && volumes[1].is_body);
}

TEST(AdviceOnRigidResults, RigidIsMeasuredByComponent) {
  const TriangleMesh both = shapes::together(shapes::grid(6, 6), shapes::icosphere(2), Vector3(20, 0, 0));
  const Region region = support::whole_region(both, {{0}, {40}}, {});
  Points after = both.vertices;
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 0));
  after.bottomRows(162) = support::moved(rigid(120, Vector3(1, 2, 3), Vector3(5, 6, 7)), Points(after.bottomRows(162)));
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 0));
  after(100, 1) += 1e-3;
  EXPECT_FALSE(moved_rigidly(region, both.vertices, after, 0));
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 1e-3));
  after = both.vertices;
  after.col(0) *= -1;
  EXPECT_FALSE(moved_rigidly(region, both.vertices, after, 0)) << "a mirror image";
}

}  // namespace
}  // namespace lapedit::advice_test
