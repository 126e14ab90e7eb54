// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/detail_rotation.h"

#include <Eigen/Geometry>
#include <cmath>

#include "lapedit/base/stopwatch.h"

namespace lapedit {
namespace {

constexpr int kGrain = 512;

/// Returns the unit vector along v, or zero if v is negligible against `scale`.
Vector3 unit_or_zero(const Vector3& v, double scale) {
  const double length = v.norm();
  if (!(length > 1e-9 * scale)) {
    return Vector3::Zero();
  }
  return v / length;
}

/// Normalises smoothed normals; where they cancel (a radius beyond a limb's thickness) it takes the vertex's own
/// normal.
void normalise(Points& smoothed, const Points& own) {
  constexpr double kCancelled = 1e-3;
  for (Eigen::Index i = 0; i < smoothed.rows(); ++i) {
    const double length = smoothed.row(i).norm();
    if (length > kCancelled) {
      smoothed.row(i) /= length;
    } else {
      smoothed.row(i) = own.row(i);
    }
  }
}

Matrix3 frame(const Vector3& n, const Vector3& u) {
  Matrix3 result;
  result << n, u, n.cross(u);
  return result;
}

}  // namespace

const char* name(DetailRotation rotation) {
  constexpr const char* kNames[] = {"none", "smooth normals", "smooth surface", "local-global"};
  return kNames[static_cast<int>(rotation)];
}

RotationEstimator::RotationEstimator(DetailRotation kind, const Region& region, const Smoother& smoother,
                                     ThreadPool& pool)
    : kind_(kind), region_(region), smoother_(smoother), pool_(pool) {}

void RotationEstimator::set_before(const Points& before) {
  if (kind_ == DetailRotation::SmoothNormals) {
    before_ = before;
    vertex_normals(before_, region_.faces, normals_before_, areas_);
    smoother_.apply(normals_before_, smooth_before_);
    normalise(smooth_before_, normals_before_);
  } else {
    smoother_.apply(before, smooth_before_);
    vertex_normals(smooth_before_, region_.faces, normals_before_, areas_);
  }
}

void RotationEstimator::set_before_smoothed(const Points& smoothed) {
  smooth_before_ = smoothed;
  vertex_normals(smooth_before_, region_.faces, normals_before_, areas_);
}

void RotationEstimator::estimate(const Points& displacement, std::vector<Matrix3>& rotations) {
  rotations.resize(region_.size());
  Stopwatch watch;
  if (kind_ == DetailRotation::SmoothNormals) {
    after_ = before_ + displacement;
    vertex_normals(after_, region_.faces, normals_after_, areas_);
    smoother_.apply(normals_after_, smooth_after_);
    normalise(smooth_after_, normals_after_);
  } else {
    smoother_.apply(displacement, scratch_);
    smooth_after_ = smooth_before_ + scratch_;
    vertex_normals(smooth_after_, region_.faces, normals_after_, areas_);
  }
  normals_ms_ = watch.lap();
  if (kind_ == DetailRotation::SmoothNormals) {
    paper_frames(rotations);
  } else {
    smooth_surface(rotations);
  }
  rotate_ms_ = watch.lap();
}

/// The paper's section 4: R takes the frame {n, u, n x u} to {n', u', n' x u'}, n and n' the smooth normals, u and u'
/// one edge's unit projections onto the planes orthogonal to them; the edge nearest to being orthogonal to n.
void RotationEstimator::paper_frames(std::vector<Matrix3>& rotations) {
  for (int i = 0; i < region_.size(); ++i) {
    const Vector3 n0 = smooth_before_.row(i).transpose();
    const Vector3 n1 = smooth_after_.row(i).transpose();
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
}

/// C_i = sum_j (P1_j - P1_i)(P0_j - P0_i)^T + |.| n1 n0^T over the edges of the smoothed surfaces P0 and P1, averaged;
/// R_i the rotation nearest to (1 - h_i) C_i + h_i |C_i| I, with h_i = 3 t^2 - 2 t^3 of the depth t in the anchor band.
void RotationEstimator::smooth_surface(std::vector<Matrix3>& rotations) {
  const int n = region_.size();
  covariances_.resize(n);
  spread_.resize(n);
  for_indices(pool_, n, kGrain, [&](int i) {
    Matrix3 covariance = Matrix3::Zero();
    for (const int j : region_.neighbours[i]) {
      covariance.noalias() +=
          (smooth_after_.row(j) - smooth_after_.row(i)).transpose() * (smooth_before_.row(j) - smooth_before_.row(i));
    }
    // Two statements, since Eigen would scale one factor first and lose the symmetry for vertices that have not moved.
    const Matrix3 normals = normals_after_.row(i).transpose() * normals_before_.row(i);
    covariances_[i] = covariance + covariance.norm() * normals;
  });
  // Where the smoothed surface has collapsed (a limb thinner than the radius) one ring of edges does not determine a
  // rotation, but sums over a few rings do. More passes gain nothing on the grid of detail_orientation_test.
  constexpr int kPasses = 4;
  for (int pass = 0; pass < kPasses; ++pass) {
    spread_.swap(covariances_);
    for_indices(pool_, n, kGrain, [&](int i) {
      Matrix3 sum = spread_[i];
      for (const int j : region_.neighbours[i]) {
        sum += spread_[j];
      }
      covariances_[i] = sum / (1 + region_.neighbours[i].size());
    });
  }
  // The surface beyond the rim does not rotate, so rotations fade out across the anchors.
  in_pieces(pool_, n, kGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const double hold = region_.anchor_depth.empty() ? 0 : smooth_step(region_.anchor_depth[i]);
      spread_[i] = (1 - hold) * covariances_[i] + hold * covariances_[i].norm() * Matrix3::Identity();
    }
    nearest_rotations(spread_.data() + first, last - first, rotations.data() + first);
  });
}

}  // namespace lapedit
