// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace lapedit {
namespace {

using Four = Floats4;

/// If the rotations of two cells differ by 180 degrees, the sum of their quaternions is short. Blending adds the
/// quaternion of the nearest cell to a sum shorter than this.
constexpr double kCancelled = 0.2;

LAPEDIT_INLINE float sum_of(Four v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}

}  // namespace

CellModel::CellModel(std::shared_ptr<const RestPose> rest, const EditSettings& settings, ThreadPool&& pool)
    : rest_(std::move(rest)),
      settings_(settings),
      cells_(make_cells(*rest_->region, rest_->local, CellPose::wanted_cells(rest_->region->size()), pool)),
      blend_((report_progress(0.05, "cells"), CellBlend(cells_, rest_->local, pool))),
      pose_(*rest_->region, rest_->local, cells_, blend_, settings_),
      paths_(*rest_->region, rest_->local, rest_->origin),
      hold_(rest_->region->size(), 0),
      fit_(cells_),
      quaternions_(cells_.count()),
      posed_(cells_.count()),
      rigid_columns_(3 * rest_->region->anchored.size()) {
  const std::vector<double>& depths = rest_->region->anchor_depth;
  std::transform(depths.begin(), depths.end(), hold_.begin(), smooth_step);
}

void CellModel::solve(const std::vector<HandleMotion>& handles, const Affine& anchors, bool quick) {
  paths_.set(handles, anchors);
  solve(quick);
}

void CellModel::solve(bool quick) {
  pose_.solve(paths_, quick);
  for (int c = 0; c < cells_.count(); ++c) {
    quaternions_[c] = Eigen::Quaterniond(pose_.rotations()[c]).coeffs();
  }
}

/// Computes q = sum_k w_k (q_k . q_0) q_k, blended with the identity by hold_. The result is continuous and does not
/// depend on the signs of the quaternions.
void CellModel::spread(std::vector<Matrix3>& rotations, ThreadPool& pool) {
  constexpr int kGrain = 1024;
  const auto n = static_cast<int>(hold_.size());
  rotations.resize(n);
  for_indices(pool, n, kGrain, [&](int i) {
    const Eigen::Vector4d towards = quaternions_[blend_.cells(0, i)];
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (int k = 0; k < CellBlend::kReach; ++k) {
      const Eigen::Vector4d& one = quaternions_[blend_.cells(k, i)];
      const auto weight = static_cast<double>(blend_.weights(k, i));
      sum += weight * one.dot(towards) * one;
    }
    sum += std::max(0.0, kCancelled - sum.norm()) * towards;
    sum.normalize();
    const double along = hold_[i] * sum[3];
    sum *= 1 - hold_[i];
    sum[3] += along;
    rotations[i] = sum.isZero(0) ? Matrix3(Matrix3::Identity())
                                 : Eigen::Quaterniond(Eigen::Vector4d(sum.normalized())).toRotationMatrix();
  });
  paths_.rotate_hanging(rotations);
}

void CellModel::fit(const LaplacianSystem& system, const Points& before, const Points& displacement,
                    std::vector<Matrix3>& rotations) {
  const std::vector<Matrix3>& fitted = fit_(system, before, displacement);
  for (int c = 0; c < cells_.count(); ++c) {
    quaternions_[c] = Eigen::Quaterniond(fitted[c]).coeffs();
  }
  spread(rotations, *system.pool);
}

struct CellModel::Displacing {
  const CellBlend& blend;
  const std::vector<double>& hold;
  const std::vector<int>& component;
  const PosedCell* cells;
  const Floats4* rigid;  // null: no component moves rigidly
  Transform* transforms;
  double* displacement;

  /// Computes the displacement f (sum_k w_k u_k + (R - I)(p_i - sum_k w_k C_k)) and R - I. The factor f falls to 0 at
  /// the region's rim; R is as in spread().
  LAPEDIT_INLINE void operator()(int i) const {
    const int* const which = &blend.cells(0, i);
    const float* const weights = &blend.weights(0, i);
    const Four towards = cells[which[0]].quaternion;
    Four q = {}, moved = {}, centre = {};
    for (int k = 0; k < CellBlend::kReach; ++k) {
      const PosedCell& one = cells[which[k]];
      q += weights[k] * sum_of(one.quaternion * towards) * one.quaternion;
      moved += weights[k] * one.moved;
      centre += weights[k] * one.centre;
    }
    q += std::max(0.0F, static_cast<float>(kCancelled) - std::sqrt(sum_of(q * q))) * towards;
    q *= 1 / std::sqrt(sum_of(q * q));
    const auto held = static_cast<float>(hold[i]);
    const float along = held * q[3];
    q *= 1 - held;
    q[3] += along;
    const float squared = sum_of(q * q);
    q = squared > 0 ? q / std::sqrt(squared) : Four{0, 0, 0, 1};
    const float x = q[0], y = q[1], z = q[2], w = q[3];
    Four* const columns = transforms[i].columns;
    columns[0] = Four{-2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0};
    columns[1] = Four{2 * (x * y - w * z), -2 * (x * x + z * z), 2 * (y * z + w * x), 0};
    columns[2] = Four{2 * (x * z + w * y), 2 * (y * z - w * x), -2 * (x * x + y * y), 0};
    Four detail = transforms[i].rest - centre;
    if (rigid != nullptr) {
      const Four* const by = rigid + 3 * static_cast<std::ptrdiff_t>(component[i]);
      detail += detail[0] * by[0] + detail[1] * by[1] + detail[2] * by[2];
    }
    moved += detail[0] * columns[0] + detail[1] * columns[1] + detail[2] * columns[2];
    for (std::ptrdiff_t e = 0; e < 3; ++e) {
      displacement[3 * static_cast<std::ptrdiff_t>(i) + e] = static_cast<double>((1 - held) * moved[e]);
    }
  }
};

/// Moves a handle vertex towards its target, according to its weight.
void CellModel::displace_handle(int i, double unit, Points& displacement) const {
  const double weight = settings_.handle_weight * rest_->region->weight(i),
               held = weight * weight / (1 + weight * weight);
  displacement.row(i) += held * (paths_.displacement(i).transpose() / unit - displacement.row(i));
}

void CellModel::displace_hanging(double unit, Transform* transforms, Points& displacement) const {
  for (const int i : paths_.hanging()) {
    if (const int g = paths_.followed(i); g >= 0) {
      displacement.row(i) = paths_.motions()[g].displacement(rest_->local.row(i).transpose()).transpose() / unit;
      for (int c = 0; c < 3; ++c) {
        transforms[i].columns[c] = floats4(paths_.rotations()[g].col(c) - Vector3::Unit(c));
      }
    }
  }
}

void CellModel::displace(double unit, Transform* transforms, Points& displacement, ThreadPool& pool) {
  constexpr int kGrain = 2048;
  const Region& region = *rest_->region;
  for (int c = 0; c < cells_.count(); ++c) {
    posed_[c] = {floats4(quaternions_[c]), floats4(pose_.displacement().row(c) / unit),
                 floats4(cells_.centres.row(c) / unit)};
  }
  const bool rigid = paths_.moves_rigidly();
  for (std::size_t k = 0; k < rigid_columns_.size(); ++k) {
    rigid_columns_[k] = floats4(paths_.rigid_motions()[k / 3].linear.col(static_cast<Eigen::Index>(k % 3)));
  }
  const Displacing displacing = {blend_,
                                 hold_,
                                 region.component,
                                 posed_.data(),
                                 rigid ? rigid_columns_.data() : nullptr,
                                 transforms,
                                 displacement.data()};
  in_pieces(pool, region.size(), kGrain, [&](int first, int last) {
    run_kernel(displacing, first, last);
    for (int i = first; i < last; ++i) {
      if (rigid) {
        const LocalMotion& along = paths_.rigid_motions()[region.component[i]];
        displacement.row(i) += along.displacement(rest_->local.row(i).transpose()).transpose() / unit;
        Four* const columns = transforms[i].columns;
        const Four before[3] = {columns[0], columns[1], columns[2]};
        for (int c = 0; c < 3; ++c) {  // (I + M)(I + L) - I
          const Four by = rigid_columns_[3 * region.component[i] + c];
          columns[c] += by + by[0] * before[0] + by[1] * before[1] + by[2] * before[2];
        }
      }
      if (region.classes[i] == VertexClass::Handle) {
        displace_handle(i, unit, displacement);
      }
    }
  });
  if (settings_.method == EditMethod::Default) {
    displace_hanging(unit, transforms, displacement);
  }
}

}  // namespace lapedit
