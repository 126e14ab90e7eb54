// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/trigonometry.h"

#include <cmath>

#include "lapedit/base/whole_part.h"

namespace lapedit {
namespace {

constexpr double kRadians = 3.14159265358979323846 / 180;

struct SineCosine {
  double sine, cosine;
};

/// Returns sine and cosine by their Taylor series about the nearest multiple of 90 degrees.
SineCosine sine_cosine(double degrees) {
  constexpr int kTerms = 11;
  const double within = std::remainder(degrees, 360);
  const double quarters = std::nearbyint(within / 90);
  const double x = (within - 90 * quarters) * kRadians;
  double sine = 0, cosine = 0;
  for (int k = kTerms; k > 0; --k) {
    sine = 1 - x * x / (2 * k * (2 * k + 1)) * (k == kTerms ? 1 : sine);
    cosine = 1 - x * x / (2 * k * (2 * k - 1)) * (k == kTerms ? 1 : cosine);
  }
  sine *= x;
  switch ((whole_part(quarters, -2, 2) + 4) % 4) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// Returns the angle in degrees whose tangent, from 0 to 1, is given.
double arc_tangent(double tangent) {
  constexpr int kTerms = 14, kHalvings = 2;
  double u = tangent;
  for (int k = 0; k < kHalvings; ++k) {
    u /= 1 + std::sqrt(1 + u * u);
  }
  double sum = 0;
  for (int k = kTerms; k >= 0; --k) {
    sum = 1.0 / (2 * k + 1) - u * u * sum;
  }
  return u * sum * (1 << kHalvings) / kRadians;
}

}  // namespace

Matrix3 rotation_about(const Vector3& axis, double degrees) {
  const auto [sine, cosine] = sine_cosine(degrees);
  Matrix3 cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return cosine * Matrix3::Identity() + sine * cross + (1 - cosine) * (axis * axis.transpose());
}

double sine_ratio(double degrees, double fraction) {
  const double whole = sine_cosine(degrees).sine;
  return whole != 0 ? sine_cosine(fraction * degrees).sine / whole : fraction;
}

AxisAngle::AxisAngle(const Matrix3& rotation) {
  Eigen::Vector4d turn = Eigen::Quaterniond(rotation).coeffs();
  if (turn[3] < 0) {
    turn = -turn;
  }
  const double sine = turn.head<3>().norm();
  if (sine > 0) {
    axis = turn.head<3>() / sine;
    degrees = 4 * arc_tangent(sine / (turn.norm() + turn[3]));
  }
}

}  // namespace lapedit
