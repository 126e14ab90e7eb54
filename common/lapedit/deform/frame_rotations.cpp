// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/frame_rotations.h"

#include <Eigen/Geometry>
#include <cmath>

#include "lapedit/base/stopwatch.h"
#include "lapedit/mesh/surface_measures.h"

namespace lapedit {
namespace {

/// Returns the unit vector along v, or zero if v is negligible against `scale`.
Vector3 unit_or_zero(const Vector3& v, double scale) {
  const double length = v.norm();
  if (!(length > 1e-9 * scale)) {
    return Vector3::Zero();
  }
  return v / length;
}

/// Normalises smoothed normals; where they cancel (a radius beyond a limb's thickness) it takes the
/// unsmoothed normal.
void normalise(Points& smoothed, const Points& raw) {
  constexpr double kCancelled = 1e-3;
  for (Eigen::Index i = 0; i < smoothed.rows(); ++i) {
    const double length = smoothed.row(i).norm();
    if (length > kCancelled) {
      smoothed.row(i) /= length;
    } else {
      smoothed.row(i) = raw.row(i);
    }
  }
}

}  // namespace

void FrameRotations::smooth(const Points& pose, Points& normals) {
  vertex_normals(pose, region_.faces, raw_, areas_);
  kernel_.apply(raw_, normals, centres_);
  normalise(normals, raw_);
}

/// The rotation that takes n0 to n1 and the edge that is most tangential at n0 to its counterpart, in the tangent
/// planes. Edges that are nearly as tangential take part, since on regular meshes rounding would choose among them:
/// each counts less the steeper it is, so that the choice has no jumps.
Matrix3 FrameRotations::tangential_rotation(int i, const Vector3& n0, const Vector3& n1) const {
  constexpr double kAsTangential = 1e-3;  // difference of cosines
  const auto cosine_of = [&](const Vector3& edge) { return std::abs(edge.dot(n0)) / edge.norm(); };
  double least = 2;
  for (const int j : region_.neighbours[i]) {
    // The minimum of a number and a NaN, of an edge without length, is the number.
    least = std::fmin(least, cosine_of((before_.row(j) - before_.row(i)).transpose()));
  }
  const Matrix3 base = Eigen::Quaterniond::FromTwoVectors(n0, n1).toRotationMatrix();
  double along = 0, across = 0;
  bool moved = n0 != n1;
  for (const int j : region_.neighbours[i]) {
    const Vector3 e0 = (before_.row(j) - before_.row(i)).transpose();
    const Vector3 e1 = (after_.row(j) - after_.row(i)).transpose();
    const double weight = 1 - (cosine_of(e0) - least) / kAsTangential;
    if (weight > 0) {
      const Vector3 u0 = base * unit_or_zero(e0 - e0.dot(n0) * n0, e0.norm());
      const Vector3 u1 = unit_or_zero(e1 - e1.dot(n1) * n1, e1.norm());
      along += weight * u0.dot(u1);
      across += weight * n1.dot(u0.cross(u1));
      moved |= e0 != e1;
    }
  }
  const double size = std::sqrt(along * along + across * across);
  if (!moved) {
    return Matrix3::Identity();
  }
  constexpr double kCancelled = 1e-9;
  if (!(size > kCancelled)) {
    return base;
  }
  const Matrix3 outer = n1 * n1.transpose();
  Matrix3 cross;
  cross << 0, -n1[2], n1[1], n1[2], 0, -n1[0], -n1[1], n1[0], 0;
  return (along / size * (Matrix3::Identity() - outer) + across / size * cross + outer) * base;
}

double FrameRotations::estimate(const Points& before, const Points& displacement, std::vector<Matrix3>& rotations) {
  const Stopwatch watch;
  if (before_.rows() != before.rows() || before_ != before) {
    before_ = before;
    smooth(before_, normals_before_);
  }
  after_ = before_ + displacement;
  smooth(after_, normals_after_);
  const double smoothing_ms = watch.elapsed();
  rotations.resize(region_.size());
  for (int i = 0; i < region_.size(); ++i) {
    const Vector3 n0 = normals_before_.row(i).transpose();
    const Vector3 n1 = normals_after_.row(i).transpose();
    rotations[i].setIdentity();
    if (n0.isZero(0) || n1.isZero(0)) {
      continue;
    }
    rotations[i] = tangential_rotation(i, n0, n1);
  }
  return smoothing_ms;
}

}  // namespace lapedit
