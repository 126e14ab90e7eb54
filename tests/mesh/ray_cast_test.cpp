// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drag_support.h"

namespace lapedit::ray_cast_test {
namespace {

const Vector3 kDown(0, 0, -1);

TEST(RayCast, FindsTheNearestTriangleAndItsNearestCorner) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Vector3 toward = Vector3(1, 2, 3).normalized();
  const auto hit = Visibility(sphere).first_hit({5 * toward, -toward});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.dot(toward), 1, 0.01);
  EXPECT_EQ(hit->vertex, support::vertex_at(sphere, hit->point));
  EXPECT_TRUE((sphere.faces.row(hit->face).array() == hit->vertex).any());
  EXPECT_FALSE(Visibility(sphere).first_hit({5 * toward, toward}));
  EXPECT_FALSE(Visibility(sphere).first_hit({5 * toward, Vector3(3, 0, -1)}));
}

TEST(RayCast, HitsFromInsideToo) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const auto hit = Visibility(sphere).first_hit({Vector3::Zero(), Vector3(0, 0.1, 2)});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.norm(), 1, 0.01);
}

TEST(RayCast, RayThroughAVertexOrAnEdgeDoesNotSlipThrough) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Visibility faces(sphere);
  for (int v = 0; v < sphere.vertices.rows(); ++v) {
    const Vector3 position = sphere.vertices.row(v).transpose();
    const auto hit = faces.first_hit({3 * position, -position});
    ASSERT_TRUE(hit) << v;
    EXPECT_EQ(hit->vertex, v);
  }
  for (Eigen::Index f = 0; f < sphere.faces.rows(); ++f) {
    const Vector3 middle =
        (sphere.vertices.row(sphere.faces(f, 0)) + sphere.vertices.row(sphere.faces(f, 1))).transpose() / 2;
    const auto hit = faces.first_hit({3 * middle, -middle});
    ASSERT_TRUE(hit) << f;
    EXPECT_LT((hit->point - middle).norm(), 1e-6);
  }
}

TEST(RayCast, LooksAlongItsDirectionOfAnyLength) {
  const TriangleMesh mesh = shapes::grid(5, 5);
  for (const double length : {1e-6, 1.0, 1e6}) {
    const auto hit = Visibility(mesh).first_hit({Vector3(1.3, 1.6, 5), length * kDown});
    ASSERT_TRUE(hit);
    EXPECT_LT((hit->point - Vector3(1.3, 1.6, 0)).norm(), 1e-9);
    EXPECT_EQ(hit->vertex, 5 * 1 + 2);
  }
  EXPECT_FALSE(Visibility(mesh).first_hit({Vector3(1.3, 1.6, -5), kDown})) << "behind the ray";
  EXPECT_FALSE(Visibility(mesh).first_hit({Vector3(1.3, 1.6, std::numeric_limits<double>::quiet_NaN()), kDown}));
}

TEST(RayCast, LooksThroughBrokenTriangles) {
  TriangleMesh mesh = shapes::together(shapes::grid(5, 5), shapes::grid(5, 5), Vector3(0, 0, 1));
  mesh.vertices.bottomRows(25).setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto hit = Visibility(mesh).first_hit({Vector3(1.3, 1.6, 5), kDown});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.z(), 0, 1e-12);
  mesh.vertices.bottomRows(25).setConstant(1);  // all in one point
  EXPECT_TRUE(Visibility(mesh).first_hit({Vector3(1.3, 1.6, 5), kDown}));
}

}  // namespace
}  // namespace lapedit::ray_cast_test
