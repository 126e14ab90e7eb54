// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/handle_transform.h"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/base/trigonometry.h"

namespace lapedit {
namespace {

void require_finite(bool finite, const char* what, const char* key) {
  if (!finite) {
    throw EditError(ErrorCause::NotFinite,
                    std::string("The handle's ") + what + " is not a finite number: give a finite one.")
        .at(key);
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
    throw EditError(ErrorCause::BadParameter,
                    "The handle's scale is " + std::to_string(transform.scale) + ": it has to be greater than 0.")
        .at("scale");
  }
  const double axis_length = transform.axis.stableNorm();
  if (transform.degrees != 0 && !(axis_length > 0)) {
    throw EditError(ErrorCause::BadParameter,
                    "The handle's rotation axis is (0, 0, 0): give a direction, for example (0, 0, 1).")
        .at("rotation.axis");
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

}  // namespace lapedit
