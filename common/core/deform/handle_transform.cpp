// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/handle_transform.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/base/refuse.h"
#include "lapedit/base/trigonometry.h"

namespace lapedit {
namespace {

void require_finite(bool finite, const char* what, const char* key) {
  if (!finite) {
    refuse_edit(ErrorCause::NotFinite, {key}, "The handle's ", what, " is not a finite number: give a finite one.");
  }
}

/// Returns the map x -> L (x - c) + c + t.
Affine about(const Matrix3& linear, const Vector3& center, const Vector3& translation) {
  Affine map;
  map.linear() = linear;
  map.translation() = center - linear * center + translation;
  return map;
}

}  // namespace

bool mirrors(const Matrix3& linear) {
  constexpr double kFlat = 1e-12;
  const double size = linear.norm();
  return linear.determinant() < -kFlat * size * size * size;
}

HandleMotion resolve(const HandleTransform& transform, const Vector3& centroid) {
  if (transform.matrix) {
    require_finite(transform.matrix->allFinite(), "matrix", "matrix");
  }
  require_finite(transform.translation.allFinite(), "translation", "translation");
  require_finite(transform.axis.allFinite(), "rotation axis", "rotation.axis");
  require_finite(std::isfinite(transform.degrees), "rotation angle", "rotation.degrees");
  require_finite(std::isfinite(transform.scale), "scale", "scale");
  require_finite(!transform.center || transform.center->allFinite(), "rotation center", "rotation.center");
  if (!(transform.scale > 0)) {
    refuse_edit(ErrorCause::BadParameter, {"scale"}, "The handle's scale is ", transform.scale,
                ": it has to be greater than 0.");
  }
  const double axis_length = transform.axis.stableNorm();
  if (transform.degrees != 0 && !(axis_length > 0)) {
    refuse_edit(ErrorCause::BadParameter, {"rotation.axis"},
                "The handle's rotation axis is (0, 0, 0): give a direction, for example (0, 0, 1).");
  }
  HandleMotion motion;
  if (transform.matrix) {
    motion.map.matrix() = *transform.matrix;
    return motion;
  }
  Matrix3 linear = transform.scale * Matrix3::Identity();
  if (transform.degrees != 0) {
    motion.rotation = HandleMotion::Rotation{transform.axis / axis_length, transform.degrees, transform.center};
    linear = rotation_about(motion.rotation->axis, transform.degrees) * transform.scale;
  }
  motion.map.translation() = transform.translation;
  if (linear != Matrix3::Identity()) {  // keeps translations free of the centre's rounding
    motion.map = about(linear, transform.center.value_or(centroid), transform.translation);
  }
  return motion;
}

LocalMotion LocalMotion::of(const Affine& map, const Vector3& origin) {
  LocalMotion motion;
  motion.linear = map.linear() - Matrix3::Identity();
  motion.translation = motion.linear * origin + map.translation();
  return motion;
}

Matrix3 LocalMotion::rotation() const {
  const Matrix3 map = linear + Matrix3::Identity();
  return linear.isZero(0) || map.determinant() < 0 ? Matrix3(Matrix3::Identity()) : polar_rotation(map);
}

MotionPath::MotionPath(const HandleMotion& to, const Vector3& origin, const Vector3& centre)
    : whole_(LocalMotion::of(to.map, origin)), centre_(centre), displacement_(whole_.displacement(centre)) {
  if (whole_.linear.isZero(0) && !to.rotation) {
    return;
  }
  const Matrix3 linear = to.map.linear();
  Matrix3 rotation;
  if (to.rotation) {
    axis_ = to.rotation->axis;
    degrees_ = to.rotation->degrees;
    rotation = rotation_about(axis_, degrees_);
  } else {
    rotation = polar_rotation(linear);
    const AxisAngle found(rotation);
    axis_ = found.axis;
    degrees_ = found.degrees;
  }
  stretch_ = rotation.transpose() * linear;
  if (to.rotation && to.rotation->center) {
    lever_ = centre + origin - *to.rotation->center;
    scale_ = stretch_.trace() / 3;
  } else if (!to.rotation || std::abs(degrees_) <= 180) {
    arc_ = degrees_;
  }
}

LocalMotion MotionPath::at(double fraction) const {
  if (fraction == 0) {
    return {};
  }
  if (fraction == 1) {
    return whole_;
  }
  LocalMotion motion;
  Vector3 displacement = fraction * displacement_;
  if (!stretch_.isIdentity(0) || degrees_ != 0) {
    const Matrix3 rotation = rotation_about(axis_, fraction * degrees_);
    motion.linear = rotation * (stretch_ + (1 - fraction) * (Matrix3::Identity() - stretch_)) - Matrix3::Identity();
    if (!lever_.isZero(0)) {
      const auto circle = [this](double p) -> Vector3 {
        return (1 + p * (scale_ - 1)) * (rotation_about(axis_, p * degrees_) * lever_) - lever_;
      };
      displacement += circle(fraction) - fraction * circle(1);
    } else if (arc_ != 0) {
      const Vector3 along = axis_ * axis_.dot(displacement_);
      displacement =
          fraction * along +
          sine_ratio(arc_ / 2, fraction) * (rotation_about(axis_, (fraction - 1) * arc_ / 2) * (displacement_ - along));
    }
  }
  motion.translation = displacement - motion.linear * centre_;
  return motion;
}

double MotionPath::length(double unit) const {
  constexpr double kDegrees = 30, kStretch = 0.25;
  return std::max({std::abs(degrees_) / kDegrees, unit > 0 ? displacement_.norm() / unit : 0,
                   (stretch_ - Matrix3::Identity()).norm() / kStretch});
}

}  // namespace lapedit
