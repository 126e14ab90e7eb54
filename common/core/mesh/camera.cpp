// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/camera.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace lapedit {
namespace {

Vector3 mapped(const Eigen::Matrix4d& matrix, const Vector3& point) {
  const Eigen::Vector4d image = matrix.leftCols<3>() * point + matrix.col(3);
  return image.head<3>() / image.w();
}

}  // namespace

Camera::Camera() : to_clip_(Eigen::Matrix4d::Identity()), from_clip_(Eigen::Matrix4d::Identity()) {}

Camera::Camera(const Eigen::Matrix4d& to_clip, double width, double height)
    : to_clip_(to_clip), width_(width), height_(height) {
  bool invertible = false;
  if (to_clip.allFinite()) {
    // Rows and columns are scaled to similar size first, so that a singular matrix has rank below 4 in any units.
    const Eigen::Vector4d rows = to_clip.cwiseAbs().rowwise().maxCoeff().cwiseInverse();
    const Eigen::Matrix4d like_rows = rows.asDiagonal() * to_clip;
    const Eigen::Vector4d columns = like_rows.cwiseAbs().colwise().maxCoeff().transpose().cwiseInverse();
    const Eigen::FullPivLU<Eigen::Matrix4d> lu(like_rows * columns.asDiagonal());
    invertible = rows.allFinite() && columns.allFinite() && lu.isInvertible();
    from_clip_ = invertible ? Eigen::Matrix4d(columns.asDiagonal() * lu.inverse() * rows.asDiagonal())
                            : Eigen::Matrix4d(Eigen::Matrix4d::Identity());
  }
  valid_ =
      invertible && from_clip_.allFinite() && width > 0 && height > 0 && std::isfinite(width) && std::isfinite(height);
}

Vector2 Camera::pixel(const Vector3& point) const {
  const Vector3 clip = mapped(to_clip_, point);
  return {(clip.x() + 1) / 2 * width_, (1 - clip.y()) / 2 * height_};
}

bool Camera::in_front(const Vector3& point) const {
  return to_clip_.row(3).head<3>().dot(point) + to_clip_(3, 3) > 0;
}

Ray Camera::ray(const Vector2& pixel) const {
  const Vector3 on_near(2 * pixel.x() / width_ - 1, 1 - 2 * pixel.y() / height_, -1);
  const Eigen::Vector4d near = from_clip_ * on_near.homogeneous();
  // The ray has the direction in which depth grows. It is not the direction to a point, since the far plane may be
  // infinitely far away.
  const Eigen::Vector4d deeper = from_clip_.col(2);
  const Vector3 way = deeper.head<3>() * near.w() - near.head<3>() * deeper.w();
  return {near.head<3>() / near.w(), way.stableNormalized()};
}

Vector3 Camera::beside(const Vector3& point, const Vector2& pixel) const {
  const double depth = mapped(to_clip_, point).z();
  return mapped(from_clip_, Vector3(2 * pixel.x() / width_ - 1, 1 - 2 * pixel.y() / height_, depth));
}

double Camera::pixel_size(const Vector3& point) const {
  const Vector2 here = pixel(point);
  return (beside(point, here + Vector2(1, 0)) - beside(point, here)).norm();
}

Vector3 Camera::toward_viewer(const Vector3& point) const {
  return -ray(pixel(point)).direction;
}

}  // namespace lapedit
