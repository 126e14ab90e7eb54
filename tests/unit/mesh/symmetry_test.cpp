// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/symmetry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "shapes.h"
#include "support.h"

namespace lapedit::symmetry_test {
namespace {

TEST(FindSymmetry, FindsThePlaneHoweverTheMeshLies) {
  TriangleMesh arm = shapes::tapered_arm(24, 60);  // symmetric across y = 0 alone
  for (const bool noisy : {false, true}) {
    if (noisy) {
      std::mt19937 random(3);
      std::normal_distribution<double> noise(0, 0.005);
      for (Eigen::Index i = 0; i < arm.vertices.size(); ++i) {
        arm.vertices.data()[i] += noise(random);
      }
    }
    for (const Affine& map : {Affine::Identity(), support::rigid(50, {1, -2, 0.5}, {30, 7, -4})}) {
      const TriangleMesh mesh = support::moved(map, arm);
      const auto plane = find_symmetry(mesh);
      ASSERT_TRUE(plane);
      EXPECT_NEAR(std::abs(plane->normal.normalized().dot(map.linear() * Vector3::UnitY())), 1, noisy ? 1e-4 : 1e-6);
      EXPECT_NEAR(plane->normal.normalized().dot(plane->point - map * Vector3::Zero()), 0, noisy ? 0.02 : 0.001);
    }
  }
}

TEST(FindSymmetry, TakesTheCoordinateAxisOfEquals) {
  const auto plane = find_symmetry(shapes::icosphere(4));
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->normal, Vector3(1, 0, 0));
  EXPECT_LT(plane->point.norm(), 1e-12);
}

TEST(FindSymmetry, FindsNothingWhereThereIsNone) {
  TriangleMesh ball = shapes::icosphere(4);
  ball.vertices.col(1) *= 2;
  ball.vertices.col(2) *= 0.3;
  const TriangleMesh mesh = shapes::together(support::moved(support::rigid(30, {1, 1, 1}, {0, 0, 0}), ball),
                                             shapes::tapered_arm(24, 60), {3, 2, 1});
  EXPECT_FALSE(find_symmetry(mesh));
  EXPECT_FALSE(find_symmetry(TriangleMesh{Points(0, 3), Faces(0, 3)}));
  const auto plane = find_symmetry(shapes::grid(30, 20));
  ASSERT_TRUE(plane);
  EXPECT_EQ(plane->normal[2], 0) << "a flat mesh is no image of itself across its own plane";
}

TEST(Asymmetry, IsTheMeanDistanceOfTheSides) {
  TriangleMesh ball = shapes::icosphere(4);
  EXPECT_LT(asymmetry(ball, {}), 1e-9);
  EXPECT_LT(asymmetry(ball, {Vector3::Zero(), Vector3(0, 0, 5)}), 1e-9);
  const double shifted = asymmetry(ball, {Vector3(0.02, 0, 0), Vector3::UnitX()});
  EXPECT_GT(shifted, 0.002);
  EXPECT_LT(shifted, 0.04 / std::sqrt(12.0));
  EXPECT_LT(shifted, asymmetry(ball, {Vector3(0.06, 0, 0), Vector3::UnitX()}));
  EXPECT_EQ(asymmetry(TriangleMesh{Points(0, 3), Faces(0, 3)}, {}), 0);
}

}  // namespace
}  // namespace lapedit::symmetry_test
