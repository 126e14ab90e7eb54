// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_pose.h"

#include <algorithm>

namespace lapedit {
namespace {

/// The number per step is fixed, so that poses change evenly with the handle; converged poses jump.
struct Passes {
  int per_step, at_the_end;
};
constexpr Passes kFull = {5, 20}, kQuick = {1, 8};
constexpr double kSettled = 1e-9;  // of the handles' largest displacement: rotations have converged

}  // namespace

int CellPose::wanted_cells(int vertices) {
  constexpr int kVerticesPerCell = 5;
  return std::min(vertices / kVerticesPerCell, kCells);
}

CellPose::CellPose(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
                   const EditSettings& settings)
    : cells_(cells),
      surface_(cells),
      system_(region, rest, cells, blend, settings),
      rotates_(settings.method != EditMethod::Linear),
      component_(cells.count(), 0),
      hold_(cells.count(), 0),
      local_global_(cells, surface_, hold_, system_),
      linear_(cells.count()),
      rotations_(cells.count(), Matrix3::Identity()) {
  for (int i = 0; i < region.size(); ++i) {
    component_[cells_.of[i]] = region.component[i];
    hold_[cells_.of[i]] += region.anchor_depth.empty() ? 0 : region.anchor_depth[i];
  }
  for (int c = 0; c < cells_.count(); ++c) {
    hold_[c] = smooth_step(hold_[c] / cells_.vertices[c]);
  }
  // Allocates all scratch memory here, so that frames allocate nothing.
  constraints_.setZero(cells.count(), 3);
  displacement_.setZero(cells.count(), 3);
  local_global_.start(cells.centres, std::vector<Matrix3>(cells.count(), Matrix3::Zero()));
  local_global_.settle(constraints_, 0, 2, displacement_, rotations_);
  displacement_.setZero();
  std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
}

/// Moves the rest pose rigidly with the components of this step.
void CellPose::move_rigidly(const GroupPaths& paths) {
  rigid_ = cells_.centres;
  for (int c = 0; c < cells_.count(); ++c) {
    const LocalMotion& along = paths.rigid_motions()[component_[c]];
    linear_[c] = along.linear;
    rigid_.row(c) += along.displacement(cells_.centres.row(c).transpose()).transpose();
  }
  local_global_.start(rigid_, linear_);
}

/// Sets the handles' constraints of this step. @return their largest displacement from the rigidly moved pose
double CellPose::constrain(const GroupPaths& paths) {
  double largest = 0;
  constraints_.setZero(cells_.count(), 3);
  for (const CoarseSystem::Held& held : system_.held()) {
    const Vector3 moved =
        held.displacement(paths) - paths.rigid_motions()[component_[held.cell]].displacement(held.mean);
    largest = std::max(largest, moved.norm());
    for (const auto& [cell, weight] : held.row) {
      constraints_.row(cell) += held.weight * weight * moved.transpose();
    }
  }
  return largest;
}

void CellPose::solve(GroupPaths& paths, bool quick) {
  displacement_.setZero(cells_.count(), 3);
  std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
  passes_ = 0;
  left_ = 0;
  const int steps = paths.steps();
  if (!rotates_) {
    move_rigidly(paths);
    constrain(paths);
    system_.solve(constraints_, displacement_);
    return;
  }
  for (int step = 1; step <= steps; ++step) {
    paths.go_to(step);
    move_rigidly(paths);
    const double moved = constrain(paths);
    if (moved == 0) {
      displacement_.setZero();
      std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
      continue;
    }
    const Passes& passes = quick ? kQuick : kFull;
    const LocalGlobal::Outcome outcome = local_global_.settle(
        constraints_, kSettled * moved, step == steps ? passes.at_the_end : passes.per_step, displacement_, rotations_);
    passes_ += outcome.passes;
    left_ = outcome.left / moved;
  }
}

}  // namespace lapedit
