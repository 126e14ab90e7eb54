// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "lapedit/base/types.h"

namespace lapedit {

/// Unit normal of a triangle, and the angles at its corners in radians.
struct FaceShape {
  Vector3 normal;
  std::array<double, 3> angles;
};

/// Measures a triangle. @return false if it has no area or a corner that is not finite
bool measure(const std::array<Vector3, 3>& corners, FaceShape& shape);

}  // namespace lapedit
