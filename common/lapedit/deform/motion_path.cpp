// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/motion_path.h"

#include <algorithm>
#include <cmath>

#include "lapedit/base/trigonometry.h"
#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {

LocalMotion LocalMotion::of(const Affine& map, const Vector3& origin) {
  LocalMotion motion;
  motion.linear = map.linear() - Matrix3::Identity();
  motion.translation = motion.linear * origin + map.translation();
  return motion;
}

MotionPath::MotionPath(const HandleMotion& to, const Vector3& origin, const Vector3& centre)
    : whole_(LocalMotion::of(to.map, origin)), centre_(centre), way_(whole_.displacement(centre)) {
  if (whole_.linear.isZero(0) && !to.turn) {
    return;
  }
  const Matrix3 linear = to.map.linear();
  Matrix3 rotation;
  if (to.turn) {
    axis_ = to.turn->axis;
    degrees_ = to.turn->degrees;
    rotation = rotation_about(axis_, degrees_);
  } else {
    rotation = polar_rotation(linear);
    const AxisAngle turn(rotation);
    axis_ = turn.axis;
    degrees_ = turn.degrees;
  }
  stretch_ = rotation.transpose() * linear;
  if (to.turn && to.turn->center) {
    lever_ = centre + origin - *to.turn->center;
    scale_ = stretch_.trace() / 3;
  } else if (!to.turn || std::abs(degrees_) <= 180) {
    arc_ = degrees_;
  }
}

LocalMotion MotionPath::at(double part) const {
  if (part == 0) {
    return {};
  }
  if (part == 1) {
    return whole_;
  }
  LocalMotion motion;
  Vector3 way = part * way_;
  if (!stretch_.isIdentity(0) || degrees_ != 0) {
    const Matrix3 rotation = rotation_about(axis_, part * degrees_);
    motion.linear = rotation * (stretch_ + (1 - part) * (Matrix3::Identity() - stretch_)) - Matrix3::Identity();
    if (!lever_.isZero(0)) {
      const auto circle = [this](double p) -> Vector3 {
        return (1 + p * (scale_ - 1)) * (rotation_about(axis_, p * degrees_) * lever_) - lever_;
      };
      way += circle(part) - part * circle(1);
    } else if (arc_ != 0) {
      const Vector3 along = axis_ * axis_.dot(way_);
      way = part * along + sine_ratio(arc_ / 2, part) * (rotation_about(axis_, (part - 1) * arc_ / 2) * (way_ - along));
    }
  }
  motion.translation = way - motion.linear * centre_;
  return motion;
}

double MotionPath::length(double unit) const {
  constexpr double kDegrees = 30, kStretch = 0.25;
  return std::max({std::abs(degrees_) / kDegrees, unit > 0 ? way_.norm() / unit : 0,
                   (stretch_ - Matrix3::Identity()).norm() / kStretch});
}

}  // namespace lapedit
