// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/handle_transform.h"

#include <cmath>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/deform/polar_decomposition.h"

namespace lapedit {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

void require_finite(bool finite, const char* what) {
  if (!finite) {
    throw EditError(ErrorCause::NotFinite,
                    std::string("The handle's ") + what + " is not a finite number: give a finite one.");
  }
}

/// x -> L (x - c) + c + t
Affine about(const Matrix3& linear, const Vector3& center, const Vector3& translation) {
  Affine map;
  map.linear() = linear;
  map.translation() = center - linear * center + translation;
  return map;
}

/// Part of the way of an affine map with L = Q S: the rotation Q by its angle, the stretch S and the way linearly.
Affine resolve_matrix(const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>& matrix, const Vector3& centroid,
                      double fraction) {
  Affine whole;
  whole.matrix() = matrix;
  if (fraction == 1) {
    return whole;
  }
  const Matrix3 linear = whole.linear();
  const Vector3 way = whole * centroid - centroid;
  Matrix3 part;
  const PolarDecomposition polar(linear);
  const Matrix3 rotation = polar.orthogonal();
  if (rotation.determinant() > 0) {
    const Eigen::AngleAxisd turn(rotation);
    part = Eigen::AngleAxisd(fraction * turn.angle(), turn.axis()).toRotationMatrix() *
           (Matrix3::Identity() + fraction * (polar.stretch() - Matrix3::Identity()));
  } else {
    part = Matrix3::Identity() + fraction * (linear - Matrix3::Identity());  // a mirror has no rotation to go part of
  }
  return about(part, centroid, fraction * way);
}

}  // namespace

Affine resolve(const HandleTransform& transform, const Vector3& centroid, double fraction) {
  require_finite(std::isfinite(fraction), "fraction");
  if (transform.matrix) {
    require_finite(transform.matrix->allFinite(), "matrix");
  }
  require_finite(transform.translation.allFinite(), "translation");
  require_finite(transform.axis.allFinite(), "rotation axis");
  require_finite(std::isfinite(transform.degrees), "rotation angle");
  require_finite(std::isfinite(transform.scale), "scale");
  require_finite(!transform.center || transform.center->allFinite(), "rotation center");
  if (!(transform.scale > 0)) {
    throw EditError(ErrorCause::BadParameter,
                    "The handle's scale is " + std::to_string(transform.scale) + ": it has to be greater than 0.");
  }
  const double axis_length = transform.axis.stableNorm();
  if (transform.degrees != 0 && !(axis_length > 0)) {
    throw EditError(ErrorCause::BadParameter,
                    "The handle's rotation axis is (0, 0, 0): give a direction, for example (0, 0, 1).");
  }
  if (fraction == 0) {
    return Affine::Identity();
  }
  if (transform.matrix) {
    return resolve_matrix(*transform.matrix, centroid, fraction);
  }
  Matrix3 linear = Matrix3::Identity();
  if (transform.degrees != 0) {
    linear = Eigen::AngleAxisd(fraction * transform.degrees * kRadiansPerDegree, transform.axis / axis_length)
                 .toRotationMatrix();
  }
  if (transform.scale != 1) {
    linear *= (1 - fraction) + fraction * transform.scale;  // exact at 1
  }
  if (linear == Matrix3::Identity()) {  // keeps a pure translation free of the centre's rounding
    Affine map = Affine::Identity();
    map.translation() = fraction * transform.translation;
    return map;
  }
  return about(linear, transform.center.value_or(centroid), fraction * transform.translation);
}

}  // namespace lapedit
