// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/cells/local_global.h"

namespace lapedit {

/// How the cells of a region move and rotate: displacements and rotations at the end of the handles' paths, which are
/// followed in steps, so that limbs bend and buckle the way that they came. With DetailRotation::None nothing rotates.
/// Deterministic to the bit.
class CellPose {
 public:
  /// Enough for the rotations of any region: 1500 were no better.
  static constexpr int kCells = 400;
  static int wanted_cells(int vertices);

  /// @param region,cells,settings  must outlive the object; blend and rest need not
  CellPose(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
           const EditSettings& settings);
  CellPose(const CellPose&) = delete;
  CellPose& operator=(const CellPose&) = delete;

  /// Goes along the paths, step by step, with a few passes for each and more for the last.
  /// @param paths   at their end before and after
  /// @param quick   in a quarter of the time and so much less accurate
  /// The result depends on nothing that came before; nothing is allocated after the first call.
  void solve(GroupPaths& paths, bool quick);

  const Points& displacement() const { return displacement_; }          ///< of the centres, from where they are carried
  const std::vector<Matrix3>& rotations() const { return rotations_; }  ///< likewise
  int passes() const { return passes_; }                                ///< of the last solve()
  double left() const { return left_; }  ///< change of its last pass over the handles' largest way

 private:
  void gather(const Region& region);
  void carry(const GroupPaths& paths);
  double ask(const GroupPaths& paths);

  const RegionCells& cells_;
  CellSurface surface_;
  CoarseSystem system_;
  bool rotates_;
  std::vector<int> component_;  // of each cell
  std::vector<double> hold_;    // how far its rotation is held back, 0 to 1
  LocalGlobal local_global_;
  std::vector<Matrix3> linear_;
  Points carried_, constraints_, displacement_;
  std::vector<Matrix3> rotations_;
  int passes_ = 0;
  double left_ = 0;
};

}  // namespace lapedit
