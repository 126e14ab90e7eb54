// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/surface_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "allocation_watch.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::surface_measures_test {
namespace {

TEST(VertexStretch, IsTheLargestChangeOfLengthAtEachVertex) {
  const TriangleMesh sheet = shapes::grid(9, 9);
  for (const int first : {0, 9}) {
    std::vector<int> set(81 - first);
    std::iota(set.begin(), set.end(), first);
    const Region region = support::region_of(sheet, support::given(set), {{80}});
    VertexStretch stretch(region, sheet.vertices);
    Points pose = sheet.vertices.bottomRows(region.size());
    for (const float value : stretch.of(pose)) {
      EXPECT_NEAR(value, 0, 1e-6);
    }
    for (const double factor : {2.0, 0.5, 1.25, 0.8}) {
      const double wanted = factor > 1 ? factor - 1 : 1 - 1 / factor;
      for (const float value : stretch.of(Points(factor * pose))) {
        EXPECT_NEAR(value, wanted, 1e-5);
      }
    }
    // One vertex pulled away: it and its neighbours know of it, the others do not.
    const int pulled = 3 * 9 + 4;
    const double edge = (pose.row(1) - pose.row(0)).norm();
    pose.row(pulled) += 3 * edge * Vector3::UnitZ().transpose();
    const std::vector<float>& at = stretch.of(pose);
    const Adjacency adjacency = build_adjacency(static_cast<int>(sheet.vertices.rows()), sheet.faces);
    for (int i = 0; i < region.size(); ++i) {
      const auto around = adjacency.neighbours[pulled + first];
      const bool near = i == pulled || std::find(around.begin(), around.end(), i + first) != around.end();
      EXPECT_EQ(at[i] > 0.5F, near) << i;
      EXPECT_GE(at[i], -1e-6) << i;
    }
    EXPECT_NEAR(at[pulled], std::sqrt(10.0) - 1, 1e-4);
  }
}

TEST(VertexStretch, IsFiniteWhateverThePose) {
  TriangleMesh sheet = shapes::grid(5, 5);
  sheet.vertices.row(1) = sheet.vertices.row(0);  // an edge without a length
  const Region region = support::whole_region(sheet, {{0}}, {});
  VertexStretch stretch(region, sheet.vertices);
  Points pose = sheet.vertices;
  pose.row(7) = pose.row(12);
  pose(3, 1) = std::numeric_limits<double>::quiet_NaN();
  pose(20, 0) = std::numeric_limits<double>::infinity();
  pose.row(18) *= 1e30;
  for (const float value : stretch.of(pose)) {
    EXPECT_LE(std::abs(value), VertexStretch::kMost);
  }
  EXPECT_EQ(stretch.of(pose)[7], -VertexStretch::kMost);
}

TEST(VertexStretch, AllocatesNothingPerPose) {
  const TriangleMesh sheet = shapes::grid(200, 200);
  const Region region = support::whole_region(sheet, {{0}}, {});
  VertexStretch stretch(region, sheet.vertices);
  stretch.of(sheet.vertices);
  const long before = allocations;
  stretch.of(sheet.vertices);
  EXPECT_EQ(allocations.load(), before);
}

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
  after.bottomRows(162) =
      support::moved(support::rigid(120, Vector3(1, 2, 3), Vector3(5, 6, 7)), Points(after.bottomRows(162)));
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 0));
  after(100, 1) += 1e-3;
  EXPECT_FALSE(moved_rigidly(region, both.vertices, after, 0));
  EXPECT_TRUE(moved_rigidly(region, both.vertices, after, 1e-3));
  after = both.vertices;
  after.col(0) *= -1;
  EXPECT_FALSE(moved_rigidly(region, both.vertices, after, 0)) << "a mirror image";
}

}  // namespace
}  // namespace lapedit::surface_measures_test
