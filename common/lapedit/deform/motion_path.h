// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/local_motion.h"

namespace lapedit {

/// The way of a handle group from where its component is carried to its target, in steps small enough for rotations to
/// follow: a turn about its own axis, at the same place, with what is not rigid fading in. Square roots and the four
/// operations only, so that its bits are the same everywhere.
class MotionPath {
 public:
  /// @param centre  of the group at rest
  MotionPath(const LocalMotion& carried, const LocalMotion& target, const Vector3& centre);

  /// A step for each 30 degrees of the turn; at least 1.
  int steps() const { return steps_; }
  /// The way of a place at rest, from where it is carried, after a part of the path from 0 to 1.
  Vector3 way(const Vector3& rest, double part) const;

 private:
  LocalMotion carried_, target_;
  Vector3 centre_, pivot_, along_;  // carried; a fixed point of the turn; the way along its axis
  Eigen::Vector4d turn_;            // quaternion x y z w, w >= 0
  Matrix3 stretch_;
  int steps_ = 1;
};

}  // namespace lapedit
