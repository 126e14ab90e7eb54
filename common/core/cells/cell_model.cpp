// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace lapedit {
namespace {

LAPEDIT_INLINE double sum_of(Doubles4 v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}

}  // namespace

CellModel::CellModel(std::shared_ptr<const RestPose> rest, const EditSettings& settings, ThreadPool&& pool)
    : rest_(std::move(rest)),
      settings_(settings),
      cells_(make_cells(*rest_->region, rest_->local, CellPose::wanted_cells(rest_->region->size()), pool)),
      blend_((report_progress(0.05, "cells"), CellBlend(cells_, rest_->local, pool))),
      pose_(*rest_->region, rest_->local, cells_, blend_, settings_),
      hold_(rest_->region->size(), 0),
      fit_(cells_),
      posed_(new PosedCell[cells_.count()]),
      detail_(rest_->local) {
  const std::vector<double>& depths = rest_->region->anchor_depth;
  std::transform(depths.begin(), depths.end(), hold_.begin(), smooth_step);
  for (int i = 0; i < rest_->region->size(); ++i) {
    for (int k = 0; k < CellBlend::kReach; ++k) {
      detail_.row(i) -= static_cast<double>(blend_.weights(k, i)) * cells_.centres.row(blend_.cells(k, i));
    }
  }
}

void CellModel::solve(GroupPaths& paths, bool quick) {
  pose_.solve(paths, quick);
}

/// Computes R from q = sum_k w_k (q_k . q_0) q_k, blended with the identity by hold, and the displacement
/// f (sum_k w_k u_k + (R - I)(p_i - sum_k w_k C_k)), whose factor f falls to 0 at the region's boundary. Both are
/// continuous and do not depend on the signs of the quaternions.
struct CellModel::Blend {
  const CellBlend& blend;
  const double* hold;
  const int* component;
  const PosedCell* cells;
  const double* detail;
  const LocalMotion* rigid;  // of each component, or null if none moves
  Matrix3* rotations;
  double* displacement;  // or null

  LAPEDIT_INLINE void operator()(int i) const {
    // If the rotations of two cells differ by 180 degrees, the sum of their quaternions is short. The quaternion of the
    // nearest cell is added to a sum shorter than this.
    constexpr double kCancelled = 0.2;
    const int* const which = &blend.cells(0, i);
    const float* const weights = &blend.weights(0, i);
    const Doubles4 towards = cells[which[0]].quaternion;
    Doubles4 q = {}, moved = {};
    for (int k = 0; k < CellBlend::kReach; ++k) {
      const PosedCell& one = cells[which[k]];
      const auto weight = static_cast<double>(weights[k]);
      q += weight * sum_of(one.quaternion * towards) * one.quaternion;
      moved += weight * one.moved;
    }
    q += std::max(0.0, kCancelled - std::sqrt(sum_of(q * q))) * towards;
    q *= 1 / std::sqrt(sum_of(q * q));
    if (hold[i] > 0) {
      const double along = hold[i] * q[3];
      q *= 1 - hold[i];
      q[3] += along;
      const double squared = sum_of(q * q);
      q = squared > 0 ? q * (1 / std::sqrt(squared)) : Doubles4{0, 0, 0, 1};
    }
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const Doubles4 columns[3] = {{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0},
                                 {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0},
                                 {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0}};
    double* const to = rotations[i].data();
    store(to, columns[0]);
    store(to + 3, columns[1]);  // over the first one's 0
    for (std::ptrdiff_t e = 0; e < 3; ++e) {
      to[6 + e] = columns[2][e];
    }
    if (displacement == nullptr) {
      return;
    }
    Doubles4 off = load3(detail + 3 * std::ptrdiff_t{i});
    if (rigid != nullptr) {
      const double* const by = rigid[component[i]].linear.data();
      off += off[0] * load3(by) + off[1] * load3(by + 3) + off[2] * load3(by + 6);
    }
    moved += off[0] * columns[0] + off[1] * columns[1] + off[2] * columns[2] - off;
    for (std::ptrdiff_t e = 0; e < 3; ++e) {
      displacement[3 * std::ptrdiff_t{i} + e] = (1 - hold[i]) * moved[e];
    }
  }
};

void CellModel::blend(const EditConstraints& constraints, std::vector<Matrix3>& rotations, Points* displacement,
                      ThreadPool& pool) {
  constexpr int kGrain = 1024;
  const Region& region = *rest_->region;
  rotations.resize(region.size());
  const Blend each = {blend_,
                      hold_.data(),
                      region.component.data(),
                      posed_.get(),
                      detail_.data(),
                      constraints.moves_rigidly() ? constraints.paths().rigid_motions().data() : nullptr,
                      rotations.data(),
                      displacement != nullptr ? displacement->data() : nullptr};
  in_pieces(pool, region.size(), kGrain, [&](int first, int last) { run_kernel(each, first, last); });
  if (settings_.method == EditMethod::Default) {
    constraints.paths().rotate_hanging(rotations);
  }
}

void CellModel::spread(const EditConstraints& constraints, std::vector<Matrix3>& rotations, Points& displacement,
                       ThreadPool& pool) {
  const Region& region = *rest_->region;
  const GroupPaths& paths = constraints.paths();
  for (int c = 0; c < cells_.count(); ++c) {
    const Eigen::Vector4d q = Eigen::Quaterniond(pose_.rotations()[c]).coeffs();
    posed_[c] = {load<Doubles4>(q.data()), load3(&pose_.displacement()(c, 0))};
  }
  displacement.resize(region.size(), 3);
  blend(constraints, rotations, &displacement, pool);
  for (const int i : constraints.handles()) {
    const double weight = settings_.handle_weight * region.weight(i), held = weight * weight / (1 + weight * weight);
    displacement.row(i) += held * (constraints.wanted().row(i) - displacement.row(i));
  }
  for (const int i : paths.hanging()) {
    if (const int g = paths.followed(i); g >= 0 && settings_.method == EditMethod::Default) {
      const Vector3 rest = rest_->local.row(i).transpose();
      displacement.row(i) =
          (paths.motions()[g].displacement(rest) - constraints.rigid_motion(i).displacement(rest)).transpose();
    }
  }
}

void CellModel::fit(const LaplacianSystem& system, const EditConstraints& constraints, const Points& displacement,
                    std::vector<Matrix3>& rotations) {
  const std::vector<Matrix3>& fitted = fit_(system, constraints.start(), displacement);
  for (int c = 0; c < cells_.count(); ++c) {
    const Eigen::Vector4d q = Eigen::Quaterniond(fitted[c]).coeffs();
    posed_[c].quaternion = load<Doubles4>(q.data());
  }
  blend(constraints, rotations, nullptr, *system.pool);
}

}  // namespace lapedit
