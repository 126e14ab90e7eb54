// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/view.h"

#include <gtest/gtest.h>

#include <limits>

#include "drag_support.h"

namespace lapedit {
namespace {

Eigen::Matrix4d orthographic(double half) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.diagonal() << 0.75 / half, 1 / half, -1 / half, 1;
  return matrix;
}

Eigen::Matrix4d perspective(double near, double far) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  matrix(0, 0) = 1.5;
  matrix(1, 1) = 2;
  matrix(2, 2) = (far + near) / (near - far);
  matrix(2, 3) = 2 * far * near / (near - far);
  matrix(3, 2) = -1;
  return matrix;
}

/// A camera 5 units away, a turned and unevenly scaled layer, in units of a scale.
Eigen::Matrix4d modelview(double scale) {
  Eigen::Affine3d map = Eigen::Translation3d(0.1 * scale, -0.2 * scale, -5 * scale) *
                        Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()) * Eigen::Scaling(1.0, 2.0, 0.5);
  return map.matrix();
}

std::vector<View> views(double scale) {
  return {View(orthographic(3 * scale) * modelview(scale), 800, 600),
          View(perspective(0.1 * scale, 100 * scale) * modelview(scale), 800, 600)};
}

TEST(View, RayGoesThroughWhatShowsAtItsPixel) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const View& view : views(scale)) {
      ASSERT_TRUE(view.valid());
      for (const Vector3& unit : {Vector3(0, 0, 0), Vector3(0.5, -0.3, 0.8), Vector3(-1, 0.4, 0.2)}) {
        const Vector3 point = scale * unit;
        EXPECT_TRUE(view.in_front(point));
        const Ray ray = view.ray(view.pixel(point));
        EXPECT_LT(ray.direction.cross(point - ray.origin).norm(), 1e-9 * scale);
        EXPECT_GT(ray.direction.dot(point - ray.origin), 0);
        EXPECT_LT((view.toward_viewer(point) + ray.direction).norm(), 1e-9);
      }
    }
  }
}

TEST(View, PixelsAreCountedFromTheUpperLeftCorner) {
  const View view(orthographic(1), 800, 600);
  EXPECT_LT((view.pixel(Vector3::Zero()) - Vector2(400, 300)).norm(), 1e-9);
  EXPECT_LT((view.pixel(Vector3(0, 1, 0)) - Vector2(400, 0)).norm(), 1e-9);
  EXPECT_LT((view.pixel(Vector3(-4.0 / 3, 0, 0)) - Vector2(0, 300)).norm(), 1e-9);
}

TEST(View, BesideStaysInThePlaneOfThePicture) {
  for (const View& view : views(1)) {
    const Vector3 point(0.2, -0.1, 0.3);
    const Vector2 pixel = view.pixel(point) + Vector2(37, -81);
    const Vector3 beside = view.beside(point, pixel);
    EXPECT_LT((view.pixel(beside) - pixel).norm(), 1e-9);
    EXPECT_LT((view.beside(point, view.pixel(point)) - point).norm(), 1e-12);
    // Parallel to the picture: as deep as the point, after the modelview matrix.
    const auto depth = [](const Vector3& p) { return (modelview(1) * p.homogeneous().eval())[2]; };
    EXPECT_NEAR(depth(beside), depth(point), 1e-9);
  }
}

TEST(View, PixelSizeIsTheWayOfAPixel) {
  for (const View& view : views(1)) {
    const Vector3 point(0.2, -0.1, 0.3);
    const Vector3 next = view.beside(point, view.pixel(point) + Vector2(10, 0));
    EXPECT_NEAR(view.pixel_size(point), (next - point).norm() / 10, 1e-9);
  }
}

TEST(View, WhatIsBehindTheCameraIsNotInFront) {
  const View view(perspective(0.1, 100), 800, 600);
  EXPECT_TRUE(view.in_front(Vector3(0, 0, -1)));
  EXPECT_FALSE(view.in_front(Vector3(0, 0, 1)));
}

TEST(View, UselessMatricesAreNotValid) {
  EXPECT_FALSE(View().valid());
  EXPECT_FALSE(View(Eigen::Matrix4d::Zero(), 800, 600).valid());
  EXPECT_FALSE(View(Eigen::Matrix4d::Identity(), 0, 600).valid());
  EXPECT_FALSE(View(Eigen::Matrix4d::Constant(std::numeric_limits<double>::quiet_NaN()), 800, 600).valid());
  Eigen::Matrix4d flat = Eigen::Matrix4d::Identity();
  flat(1, 1) = 0;
  EXPECT_FALSE(View(flat, 800, 600).valid());
}

}  // namespace
}  // namespace lapedit
