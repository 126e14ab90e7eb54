// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/cells/local_global.h"

namespace lapedit {

/// The pose of the cells of a region: displacements and rotations at the end of the handles' paths. The paths are
/// followed in steps, so that a limb bends to the side from which the handle came. With EditMethod::Linear nothing
/// rotates. Results have the same bits everywhere.
class CellPose {
 public:
  /// The usual number of cells. 1500 cells gave no better rotations.
  static constexpr int kCells = 400;
  /// Returns the number of cells for a region of so many vertices.
  static int wanted_cells(int vertices);

  /// @param region,cells,settings  must outlive the object; blend and rest need not
  CellPose(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
           const EditSettings& settings);
  CellPose(const CellPose&) = delete;
  CellPose& operator=(const CellPose&) = delete;

  /// Follows the paths step by step, with a few passes per step and more in the last one.
  /// @param paths   at their ends before and after the call
  /// @param quick   takes a quarter of the time, with a larger error
  /// The result does not depend on earlier calls. Nothing is allocated after the first call.
  void solve(GroupPaths& paths, bool quick);

  const Points& displacement() const { return displacement_; }          ///< of the centres, from the rigidly moved pose
  const std::vector<Matrix3>& rotations() const { return rotations_; }  ///< likewise
  int passes() const { return passes_; }                                ///< of the last solve()
  double left() const { return left_; }  ///< change in the last pass, over the handles' largest displacement

 private:
  void move_rigidly(const GroupPaths& paths);
  double constrain(const GroupPaths& paths);
  void follow(const GroupPaths& paths);
  void resist_twist();
  int last_passes(bool quick) const;

  const RegionCells& cells_;
  CellSurface surface_;
  CoarseSystem system_;
  bool rotates_;
  std::vector<int> component_;  // of each cell
  std::vector<double> hold_;    // by how much its rotation is reduced, 0 to 1
  std::vector<double> inertia_;
  LocalGlobal local_global_;
  std::vector<Matrix3> linear_;
  Points rigid_, constraints_, displacement_;
  std::vector<Matrix3> rotations_, group_rotations_, rigid_rotations_;  // the last two of the last step
  Points turns_, turned_;  // see eighth(): what the groups rotate the cells by in this step and so far
  int passes_ = 0;
  double left_ = 0;
};

}  // namespace lapedit
