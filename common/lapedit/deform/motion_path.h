// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/handle_transform.h"

namespace lapedit {

/// A map x -> L x + t as "minus identity", about a local origin: keeps a translation of a far-away mesh exact.
struct LocalMotion {
  Matrix3 linear = Matrix3::Zero();       ///< L - I
  Vector3 translation = Vector3::Zero();  ///< displacement of the local origin

  static LocalMotion of(const Affine& map, const Vector3& origin);
  Vector3 displacement(const Vector3& local) const { return linear * local + translation; }
  bool none() const { return linear.isZero(0) && translation.isZero(0); }
};

/// The path of a handle group from rest to its target. It rotates at an even rate; scale and shear grow at an even
/// rate. Its centroid goes along the arc that a rotation of at most 180 degrees about one axis describes (a screw); in
/// a circle where the rotation has a centre of its own; and straight where it rotates by more without one, or not at
/// all. The path to a part of the target is that part of the path. The bits are the same on every processor.
class MotionPath {
 public:
  MotionPath() = default;
  /// @param to      all of the way; HandleMotion::part and targets are not looked at
  /// @param origin  of local coordinates
  /// @param centre  centroid of the group at rest, local
  MotionPath(const HandleMotion& to, const Vector3& origin, const Vector3& centre);

  /// The motion after a part of the path from 0 to 1; exactly the identity at 0 and the target at 1.
  LocalMotion at(double part) const;

  /// Length of the path, where 30 degrees of rotation, a way of `unit` or a quarter of a stretch are 1.
  double length(double unit) const;

 private:
  LocalMotion whole_;
  Vector3 centre_ = Vector3::Zero(), way_ = Vector3::Zero(), axis_ = Vector3::UnitZ();
  Vector3 lever_ = Vector3::Zero();  // from the centre of the rotation to the centroid
  Matrix3 stretch_ = Matrix3::Identity();
  double degrees_ = 0, arc_ = 0;
  double scale_ = 1;  // of the lever
};

}  // namespace lapedit
