// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/cell_surface.h"
#include "lapedit/deform/coarse_system.h"
#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/geodesic_falloff.h"

namespace lapedit {

/// Where the cells of a region go, and how they turn: an edit's unrotated result and its rotation passes, all on the
/// cells (method: LaplacianEditor's, on RegionCells and CoarseSystem).
class CellPose {
 public:
  /// All must outlive the object. @param normal_radius  as for CoarseSystem
  CellPose(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
           const EditSettings& settings, double normal_radius, ThreadPool& pool);

  /// @param paths  at their end. Nothing is allocated after the first call
  void solve(const GroupPaths& paths);

  const Points& displacement() const { return displacement_; }          ///< of the centres, from where they are carried
  const std::vector<Matrix3>& rotations() const { return rotations_; }  ///< likewise
  const LocalMotion& carried(int cell) const { return paths_->carried()[component_[cell]]; }

 private:
  void measure_falloff(const Region& region, const Points& rest);
  void fall_off();
  void fit_rotations();
  void turn(Points& turned) const;

  const Points& rest_;
  const RegionCells& cells_;
  const EditSettings& settings_;
  ThreadPool& pool_;
  CellSurface surface_;
  CoarseSystem system_;
  std::vector<int> component_;  // of each cell
  std::vector<double> hold_;    // how far its rotation is held back, 0 to 1
  double settled_;              // a pass that changes less is the last
  GeodesicFalloff falloff_;     // of the cells; empty: rotations are estimated from the unrotated result

  const GroupPaths* paths_ = nullptr;
  Points smooth_rest_, constraints_, displacement_, previous_, turned_, smooth_before_, smooth_after_;
  std::vector<Matrix3> rotations_;
};

}  // namespace lapedit
