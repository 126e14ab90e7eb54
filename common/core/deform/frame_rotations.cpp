// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/frame_rotations.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lapedit/base/progress.h"
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

/// Normalises smoothed normals. Where they cancel (if the radius exceeds a limb's thickness), uses the unsmoothed
/// normal.
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

/// Returns the cosine between a vector and the direction n or -n; NaN for zero.
double cosine_to(const Vector3& n, const Vector3& vector) {
  return std::abs(vector.dot(n)) / vector.norm();
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

double FrameRotations::tie(int i, int j, const Vector3& n0, double least) const {
  constexpr double kTie = 1e-5;  // difference of cosines
  const double weight = 1 - (cosine_to(n0, (before_.row(j) - before_.row(i)).transpose()) - least) / kTie;
  return weight > 0 ? weight : 0;  // 0 for an edge without length
}

bool FrameRotations::has_moving_tie(int i, const Vector3& n0, double least) const {
  const CompressedRows::Row ring = region_.neighbours[i];
  return std::any_of(ring.begin(), ring.end(), [&](int j) {
    return tie(i, j, n0, least) > 0 && before_.row(j) - before_.row(i) != after_.row(j) - after_.row(i);
  });
}

/// On a regular mesh several edges are as tangential as the best one, and rounding or numbering would choose one. So
/// the rotation is about n1 to the mean of all of them. Edges that stay the most tangential have the largest weights,
/// since their projections are the most reliable. Weights are continuous. If one edge alone is the best, the result
/// keeps its bits.
Matrix3 FrameRotations::blended_ties(int i, const Vector3& n0, const Vector3& n1, double least,
                                     const Matrix3& rotation) const {
  constexpr double kAfter = 0.01;  // difference of cosines
  constexpr double kCancelled = 1e-9;
  const auto after = [&](int j) -> Vector3 { return (after_.row(j) - after_.row(i)).transpose(); };
  double least_after = 2;
  int ties = 0;
  for (const int j : region_.neighbours[i]) {
    if (tie(i, j, n0, least) > 0) {
      ++ties;
      const double cosine = cosine_to(n1, after(j));
      least_after = cosine < least_after ? cosine : least_after;
    }
  }
  double along = 0, across = 0;
  for (const int j : region_.neighbours[i]) {
    const double weight = ties < 2 ? 0 : tie(i, j, n0, least) * (1 - (cosine_to(n1, after(j)) - least_after) / kAfter);
    if (weight > 0) {
      const Vector3 e0 = (before_.row(j) - before_.row(i)).transpose(), e1 = after(j);
      const Vector3 u0 = rotation * unit_or_zero(e0 - e0.dot(n0) * n0, e0.norm());
      const Vector3 u1 = unit_or_zero(e1 - e1.dot(n1) * n1, e1.norm());
      along += weight * u0.dot(u1);
      across += weight * n1.dot(u0.cross(u1));
    }
  }
  const double size = std::sqrt(along * along + across * across);
  if (!(size > kCancelled)) {
    return rotation;
  }
  const double cosine = along / size, sine = across / size;
  Matrix3 about;
  about << 0, -n1[2], n1[1], n1[2], 0, -n1[0], -n1[1], n1[0], 0;
  about = sine * about + (1 - cosine) * n1 * n1.transpose();
  about.diagonal().array() += cosine;
  return about * rotation;
}

void FrameRotations::estimate(const Points& before, const Points& displacement, std::vector<Matrix3>& rotations) {
  if (!is_smooth_ || before_ != before) {
    is_smooth_ = false;
    before_ = before;
    smooth(before_, normals_before_);
    is_smooth_ = true;
  }
  after_ = before_ + displacement;
  smooth(after_, normals_after_);
  rotations.resize(region_.size());
  Checkpoints checkpoints;
  for (int i = 0; i < region_.size(); ++i) {
    checkpoints();
    const Vector3 n0 = normals_before_.row(i).transpose();
    const Vector3 n1 = normals_after_.row(i).transpose();
    rotations[i].setIdentity();
    if (n0.isZero(0) || n1.isZero(0)) {
      continue;
    }
    int best = -1;
    double least = 2;
    for (const int j : region_.neighbours[i]) {
      const double cosine = cosine_to(n0, (before_.row(j) - before_.row(i)).transpose());
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
      if (n0 == n1 && e0 == e1 && !has_moving_tie(i, n0, least)) {
        continue;
      }
    }
    if (u0.isZero(0) || u1.isZero(0)) {
      rotations[i] = Eigen::Quaterniond::FromTwoVectors(n0, n1).toRotationMatrix();
    } else {
      rotations[i] = blended_ties(i, n0, n1, least, frame(n1, u1) * frame(n0, u0).transpose());
    }
  }
}

}  // namespace lapedit
