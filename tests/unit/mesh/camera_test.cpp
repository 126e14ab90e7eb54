// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/camera.h"

#include <gtest/gtest.h>

#include <limits>

#include "drag_support.h"

namespace lapedit::camera_test {
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

std::vector<Camera> views(double scale) {
  return {Camera(orthographic(3 * scale) * modelview(scale), 800, 600),
          Camera(perspective(0.1 * scale, 100 * scale) * modelview(scale), 800, 600)};
}

TEST(View, RayGoesThroughWhatShowsAtItsPixel) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const Camera& view : views(scale)) {
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
  const Camera view(orthographic(1), 800, 600);
  EXPECT_LT((view.pixel(Vector3::Zero()) - Vector2(400, 300)).norm(), 1e-9);
  EXPECT_LT((view.pixel(Vector3(0, 1, 0)) - Vector2(400, 0)).norm(), 1e-9);
  EXPECT_LT((view.pixel(Vector3(-4.0 / 3, 0, 0)) - Vector2(0, 300)).norm(), 1e-9);
}

TEST(View, BesideStaysInThePlaneOfThePicture) {
  for (const Camera& view : views(1)) {
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

/// The pixel of a perspective picture shows more of the scene the farther away it is.
TEST(View, PixelSizeIsKnownOfPlainCameras) {
  const Camera far_off(perspective(0.1, 100), 800, 600);
  EXPECT_NEAR(far_off.pixel_size(Vector3(0.3, 0.2, -7)), 7 / 1.5 / 400, 1e-12);
  const Camera parallel(orthographic(3), 800, 600);
  EXPECT_NEAR(parallel.pixel_size(Vector3(0.3, 0.2, -0.5)), 0.01, 1e-12);
}

TEST(View, RaysBeginAtTheNearPlaneAndTheFarOneMayBeInfinitelyFarAway) {
  Eigen::Matrix4d endless = perspective(0.1, 100);
  endless(2, 2) = -1;
  endless(2, 3) = -0.2;
  for (const Eigen::Matrix4d& matrix : {endless, perspective(0.1, 100)}) {
    const Camera view(matrix, 800, 600);
    ASSERT_TRUE(view.valid());
    const Vector3 point(0.5, 0.3, -20);
    const Ray ray = view.ray(view.pixel(point));
    EXPECT_LT((ray.direction - point.normalized()).norm(), 1e-9);
    EXPECT_NEAR(ray.origin.z(), -0.1, 1e-9);
  }
  const Ray parallel_ray = Camera(orthographic(3), 800, 600).ray(Vector2(200, 450));
  EXPECT_LT((parallel_ray.origin - Vector3(-2, -1.5, 3)).norm(), 1e-12);
  EXPECT_LT((parallel_ray.direction - Vector3(0, 0, -1)).norm(), 1e-12);
}

TEST(View, UselessMatricesAreNotValid) {
  EXPECT_FALSE(Camera().valid());
  EXPECT_FALSE(Camera(Eigen::Matrix4d::Zero(), 800, 600).valid());
  EXPECT_TRUE(Camera(Eigen::Matrix4d::Identity(), 800, 600).valid());
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), kUnreached}) {
    EXPECT_FALSE(Camera(Eigen::Matrix4d::Identity(), bad, 600).valid()) << bad;
    EXPECT_FALSE(Camera(Eigen::Matrix4d::Identity(), 800, bad).valid()) << bad;
  }
  EXPECT_FALSE(Camera(Eigen::Matrix4d::Constant(std::numeric_limits<double>::quiet_NaN()), 800, 600).valid());
  Eigen::Matrix4d flat = perspective(0.1, 100) * modelview(1);
  flat.row(1) = 2 * flat.row(0);
  EXPECT_FALSE(Camera(flat, 800, 600).valid());
  flat = perspective(0.1, 100) * modelview(1);
  flat.col(2).setZero();
  EXPECT_FALSE(Camera(flat, 800, 600).valid());
}

}  // namespace
}  // namespace lapedit::camera_test
