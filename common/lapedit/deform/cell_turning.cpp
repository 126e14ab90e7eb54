// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/cell_turning.h"

#include <algorithm>

namespace lapedit {
namespace {

constexpr int kPassesOnTheWay = 5, kMostPasses = 600;
constexpr double kAccurate = 1e-9;          // of the handles' largest way
constexpr double kAccurateForFrame = 1e-5;  // of that or of the region's size, whichever is larger

}  // namespace

int CellTurning::wanted_cells(int vertices) {
  constexpr int kVerticesPerCell = 5;
  return std::min(vertices / kVerticesPerCell, kCells);
}

CellTurning::CellTurning(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
                         const EditSettings& settings, CholeskyBackend backend, ThreadPool& pool)
    : cells_(cells),
      surface_(cells),
      system_(region, rest, cells, blend, settings, backend, 0, pool),
      component_(cells.count(), 0),
      hold_(cells.count(), 0),
      local_global_(cells, surface_, hold_, settings, system_),
      size_(region.max_distance),
      linear_(cells.count()),
      rotations_(cells.count(), Matrix3::Identity()) {
  gather(region, rest);
  // All scratch has its size from here on, whatever the first frame of a drag asks for.
  constraints_.setZero(cells.count(), 3);
  displacement_.setZero(cells.count(), 3);
  local_global_.start(cells.centres, std::vector<Matrix3>(cells.count(), Matrix3::Zero()));
  local_global_.settle(constraints_, 0, 2, true, displacement_, rotations_);
  displacement_.setZero();
  std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
}

/// What of vertices counts for cells and groups.
void CellTurning::gather(const Region& region, const Points& rest) {
  groups_.resize(1 + *std::max_element(region.group.begin(), region.group.end()));
  for (int i = 0; i < region.size(); ++i) {
    component_[cells_.of[i]] = region.component[i];
    hold_[cells_.of[i]] += region.anchor_depth.empty() ? 0 : region.anchor_depth[i];
    if (region.group[i] >= 0) {
      Group& group = groups_[region.group[i]];
      group.component = region.component[i];
      group.centre += rest.row(i).transpose();
      ++group.size;
    }
  }
  for (Group& group : groups_) {
    group.centre /= std::max(group.size, 1);
  }
  for (int c = 0; c < cells_.count(); ++c) {
    const double depth = hold_[c] / cells_.vertices[c];
    hold_[c] = depth * depth * (3 - 2 * depth);
  }
}

/// Only while nothing is carried, and by less than about 30 degrees a group.
bool CellTurning::may_go_on(const std::vector<LocalMotion>& targets, const std::vector<LocalMotion>& carried) const {
  constexpr double kFar = 0.7;
  if (!solved_ || last_targets_.size() != targets.size() ||
      !std::all_of(carried.begin(), carried.end(), [](const LocalMotion& motion) { return motion.none(); })) {
    return false;
  }
  for (std::size_t g = 0; g < targets.size(); ++g) {
    if (!((targets[g].linear - last_targets_[g].linear).norm() < kFar)) {
      return false;
    }
  }
  return true;
}

/// What the handles ask for after a part of their way. @return the largest of it
double CellTurning::ask(double part) {
  double largest = 0;
  constraints_.setZero(cells_.count(), 3);
  for (const CoarseSystem::Held& held : system_.held()) {
    const Vector3 way = paths_[held.group].way(held.mean, part);
    largest = std::max(largest, way.norm());
    for (const auto& [cell, weight] : held.row) {
      constraints_.row(cell) += held.weight * weight * way.transpose();
    }
  }
  return largest;
}

void CellTurning::solve(const std::vector<LocalMotion>& targets, const std::vector<LocalMotion>& carried,
                        bool goes_on) {
  const bool warm = goes_on && may_go_on(targets, carried);
  last_targets_ = targets;
  paths_.clear();
  int steps = 1;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    paths_.emplace_back(carried[groups_[g].component], targets[g], groups_[g].centre);
    steps = std::max(steps, paths_.back().steps());
  }
  carried_ = cells_.centres;
  for (int c = 0; c < cells_.count(); ++c) {
    const LocalMotion& along = carried[component_[c]];
    linear_[c] = along.linear;
    carried_.row(c) += along.displacement(cells_.centres.row(c).transpose()).transpose();
  }
  local_global_.start(carried_, linear_);
  if (!warm) {
    displacement_.setZero(cells_.count(), 3);
    std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
  }
  passes_ = 0;
  left_ = turned_ = 0;
  solved_ = true;
  for (int step = warm ? steps : 1; step <= steps; ++step) {
    const bool last = step == steps;
    const double way = ask(last ? 1 : static_cast<double>(step) / steps);
    if (way == 0) {
      displacement_.setZero();
      std::fill(rotations_.begin(), rotations_.end(), Matrix3::Identity());
      continue;
    }
    const double accurate = goes_on ? kAccurateForFrame * std::max(way, size_) : kAccurate * way;
    const LocalGlobal::Outcome outcome = local_global_.settle(
        constraints_, accurate, last ? kMostPasses : kPassesOnTheWay, warm, displacement_, rotations_);
    passes_ += outcome.passes;
    left_ = outcome.left / way;
    turned_ = outcome.turned;
  }
}

}  // namespace lapedit
