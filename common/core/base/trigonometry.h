// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/base/types.h"

// Sines and cosines from the four operations and square roots only, since those of the C library differ in the last bit
// between processors and versions.

namespace lapedit {

/// Returns the rotation by an angle of any size about a unit axis, to 1e-15; multiples of 90 degrees are exact.
Matrix3 rotation_about(const Vector3& axis, double degrees);

/// Returns sin(fraction * angle) / sin(angle) for an angle of at most 90 degrees; `fraction` for an angle of 0.
double sine_ratio(double degrees, double fraction);

/// A rotation's angle, 0 to 180 degrees, and unit axis; the z axis for the identity.
struct AxisAngle {
  Vector3 axis = Vector3::UnitZ();
  double degrees = 0;

  explicit AxisAngle(const Matrix3& rotation);
};

}  // namespace lapedit
