// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lapedit {
namespace {

/// The number of passes per step is fixed, so that the pose changes evenly with the handle. If each step converged
/// fully, the pose would jump.
struct Passes {
  int per_step, at_the_end;
};
constexpr Passes kFull = {5, 20}, kQuick = {1, 8};
constexpr int kBending = 180;  // additional passes of the last step if a limb is bent by a whole revolution
constexpr double kInertia = 0.5;
constexpr double kSettled = 1e-9;  // fraction of the handles' largest displacement at which passes have converged

/// Returns the tangent of an eighth of the angle, along the axis: nearly proportional to the angle.
Vector3 eighth(const Matrix3& rotation) {
  Eigen::Vector4d turn = Eigen::Quaterniond(rotation).coeffs();
  if (turn[3] < 0) {
    turn = -turn;
  }
  for (int halving = 0; halving < 2; ++halving) {
    turn[3] += turn.norm();
  }
  return turn.head<3>() / turn[3];
}

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
      inertia_(cells.count(), kInertia),
      local_global_(cells, surface_, hold_, inertia_, system_),
      linear_(cells.count()),
      rotations_(cells.count(), Matrix3::Identity()) {
  for (int i = 0; i < region.size(); ++i) {
    component_[cells_.of[i]] = region.component[i];
    hold_[cells_.of[i]] += region.anchor_depth.empty() ? 0 : region.anchor_depth[i];
  }
  for (int c = 0; c < cells_.count(); ++c) {
    hold_[c] = smooth_step(hold_[c] / cells_.vertices[c]);
  }
  // Allocates all scratch memory here, so that no frame allocates memory.
  constraints_.setZero(cells.count(), 3);
  displacement_.setZero(cells.count(), 3);
  local_global_.start(cells.centres, std::vector<Matrix3>(cells.count(), Matrix3::Zero()), false);
  local_global_.settle(constraints_, 0, 2, displacement_, rotations_);
  turns_.setZero(cells.count(), 3);
  displacement_.setZero();
  std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
}

/// Moves the cells' rest positions rigidly with their components' motions in this step.
void CellPose::move_rigidly(const GroupPaths& paths) {
  rigid_ = cells_.centres;
  for (int c = 0; c < cells_.count(); ++c) {
    const LocalMotion& along = paths.rigid_motions()[component_[c]];
    linear_[c] = along.linear;
    rigid_.row(c) += along.displacement(cells_.centres.row(c).transpose()).transpose();
  }
  local_global_.start(rigid_, linear_, paths.has_targets());
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

/// Rotates each cell by the groups' rotations in this step, in proportion to follow(). This counts whole revolutions. A
/// cell that follows a single group starts with the rotation of that group.
void CellPose::follow(const GroupPaths& paths) {
  if (paths.rotations() != group_rotations_) {
    turns_.setZero();
    for (std::size_t k = 0; k < system_.groups().size(); ++k) {
      const int g = system_.groups()[k];
      const Matrix3 by = paths.rotations()[g] * group_rotations_[g].transpose();
      turns_.noalias() += system_.follow().col(static_cast<Eigen::Index>(k)) * eighth(by).transpose();
    }
    for (int c = 0; c < cells_.count(); ++c) {  // by (1 + v)^4 / |1 + v|^4, a quaternion
      const double v = turns_.row(c).squaredNorm(), unit = 1 / ((1 + v) * (1 + v)), along = 4 * (1 - v) * unit;
      const Eigen::Quaterniond by((1 - 6 * v + v * v) * unit, along * turns_(c, 0), along * turns_(c, 1),
                                  along * turns_(c, 2));
      rotations_[c] = by.toRotationMatrix() * rotations_[c];
    }
    turned_ += turns_;
    group_rotations_ = paths.rotations();
  }
  if (paths.rigid_rotations() != rigid_rotations_) {
    for (int c = 0; c < cells_.count(); ++c) {
      rotations_[c] *= rigid_rotations_[component_[c]] * paths.rigid_rotations()[component_[c]].transpose();
    }
    rigid_rotations_ = paths.rigid_rotations();
  }
}

/// Raises the inertia of cells that are twisted by more than kTwist against their neighbours, so that they keep their
/// initial rotations. Otherwise the passes would narrow a strongly twisted limb to a neck, where it passes through
/// itself and untwists.
void CellPose::resist_twist() {
  constexpr double kTwist = 0.07;  // radians, 4 degrees
  for (int a = 0; a < cells_.count(); ++a) {
    double sum = 0, squares = 0;
    for (const int b : cells_.neighbours[a]) {
      const Eigen::RowVector3d edge = rigid_.row(b) - rigid_.row(a);
      sum += 8 * edge.dot(turned_.row(b) - turned_.row(a));
      squares += edge.squaredNorm();
    }
    if (squares > 0) {
      const double twist = sum * sum / (squares * cells_.neighbours[a].size() * kTwist * kTwist);
      inertia_[a] = kInertia + twist * twist;
    }
  }
}

/// Returns the number of passes of the last step. A limb that is bent nearly into a ring converges slowly; a twisted
/// limb must not converge, see resist_twist(). One pass more hardly changes the pose, so the pose does not jump where
/// the number changes.
int CellPose::last_passes(bool quick) const {
  constexpr double kHalf = 3.14159265358979323846 / 8;  // half a revolution; turned_ has eighths of angles
  constexpr double kTwisted = 0.6, kBent = 0.2;         // fraction of the rotation between cells about their edges
  const double most = largest_row(turned_);
  if (quick || most <= kHalf) {
    return quick ? kQuick.at_the_end : kFull.at_the_end;
  }
  double twist = 0, all = 0;
  for (int a = 0; a < cells_.count(); ++a) {
    for (const int b : cells_.neighbours[a]) {
      const Eigen::RowVector3d edge = rigid_.row(b) - rigid_.row(a), turn = turned_.row(b) - turned_.row(a);
      twist += edge.dot(turn) * edge.dot(turn) / edge.squaredNorm();
      all += turn.squaredNorm();
    }
  }
  const double bent = std::clamp((kTwisted * all - twist) / ((kTwisted - kBent) * std::max(all, 1e-300)), 0.0, 1.0);
  return kFull.at_the_end + static_cast<int>(kBending * bent * std::min(most / kHalf - 1, 1.0));
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
  paths.go_to(0);
  group_rotations_ = paths.rotations();
  rigid_rotations_ = paths.rigid_rotations();
  turned_.setZero(cells_.count(), 3);
  std::fill(inertia_.begin(), inertia_.end(), kInertia);
  for (int step = 1; step <= steps; ++step) {
    paths.go_to(step);
    move_rigidly(paths);
    const double moved = constrain(paths);
    follow(paths);
    if (moved == 0 && (passes_ == 0 || !paths.revolves())) {
      displacement_.setZero();
      std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
      continue;
    }
    if (!quick || step == steps) {
      resist_twist();
    }
    const int passes = step == steps ? last_passes(quick) : quick ? kQuick.per_step : kFull.per_step;
    const LocalGlobal::Outcome outcome =
        local_global_.settle(constraints_, kSettled * moved, passes, displacement_, rotations_);
    passes_ += outcome.passes;
    left_ = moved > 0 ? outcome.left / moved : 0;
  }
}

}  // namespace lapedit
