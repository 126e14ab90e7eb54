// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/motion_path.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {

MotionPath::MotionPath(const LocalMotion& carried, const LocalMotion& target, const Vector3& centre)
    : carried_(carried),
      target_(target),
      centre_(centre + carried.displacement(centre)),
      pivot_(centre_),
      along_(target.displacement(centre) - carried.displacement(centre)),
      turn_(0, 0, 0, 1),
      stretch_(Matrix3::Identity()) {
  const Matrix3 from = carried.linear + Matrix3::Identity();
  const Matrix3 linear = (target.linear + Matrix3::Identity()) * from.inverse();
  if (!linear.allFinite() || linear.isIdentity(0)) {
    return;
  }
  const Matrix3 rotation = PolarDecomposition(linear).rotation();
  stretch_ = rotation.transpose() * linear;
  const Eigen::Quaterniond quaternion(rotation);
  turn_ = quaternion.coeffs() * (quaternion.w() < 0 ? -1 : 1);
  // cos(angle / 2) where the angle is 30 degrees, 60 and so on.
  constexpr double kCosines[] = {0.96592582628906829, 0.86602540378443865, 0.70710678118654752, 0.5,
                                 0.25881904510252076};
  constexpr double kRounding = 1e-9;  // a quarter of a turn is three steps, however it is given
  for (const double cosine : kCosines) {
    steps_ += turn_[3] < cosine - kRounding;
  }
  if (steps_ == 1) {
    return;  // hardly a turn: straight on
  }
  const Vector3 axis = turn_.head<3>().normalized();
  const Vector3 way = along_;
  along_ = axis * axis.dot(way);
  pivot_ = centre_ + (Matrix3::Identity() - rotation + axis * axis.transpose()).inverse() * (way - along_);
}

Vector3 MotionPath::way(const Vector3& rest, double part) const {
  const Vector3 carried = carried_.displacement(rest);
  if (part == 1) {
    return target_.displacement(rest) - carried;
  }
  Eigen::Vector4d turn = part * turn_;
  turn[3] += 1 - part;
  const Matrix3 rotation = Eigen::Quaterniond(Eigen::Vector4d(turn.normalized())).toRotationMatrix();
  const Vector3 from = rest + carried;
  const Vector3 stretched = (from - centre_) + part * ((stretch_ * (from - centre_)) - (from - centre_));
  return pivot_ + rotation * (centre_ - pivot_) + rotation * stretched + part * along_ - from;
}

}  // namespace lapedit
