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

Matrix3 frame(const Vector3& n, const Vector3& u) {
  Matrix3 result;
  result << n, u, n.cross(u);
  return result;
}

}  // namespace

void FrameRotations::smooth(const Points& pose, Points& normals) {
  vertex_normals(pose, region_.faces, raw_, areas_);
  kernel_.apply(raw_, normals, centres_);
  normalise(normals, raw_);
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
    int best = -1;
    double least = 2;
    for (const int j : region_.neighbours[i]) {
      const Vector3 edge = (before_.row(j) - before_.row(i)).transpose();
      const double cosine = std::abs(edge.dot(n0)) / edge.norm();
      if (cosine < least) {  // false for an edge without length
        least = cosine;
        best = j;
      }
    }
    Vector3 u0 = Vector3::Zero(), u1 = Vector3::Zero();
    if (best >= 0) {
      const Vector3 e0 = (before_.row(best) - before_.row(i)).transpose();
      const Vector3 e1 = (after_.row(best) - after_.row(i)).transpose();
      u0 = unit_or_zero(e0 - e0.dot(n0) * n0, e0.norm());
      u1 = unit_or_zero(e1 - e1.dot(n1) * n1, e1.norm());
      if (n0 == n1 && e0 == e1) {
        continue;
      }
    }
    if (u0.isZero(0) || u1.isZero(0)) {
      rotations[i] = Eigen::Quaterniond::FromTwoVectors(n0, n1).toRotationMatrix();
    } else {
      rotations[i] = frame(n1, u1) * frame(n0, u0).transpose();
    }
  }
  return smoothing_ms;
}

}  // namespace lapedit
