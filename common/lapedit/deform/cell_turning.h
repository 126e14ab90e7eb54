// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/local_global.h"
#include "lapedit/deform/motion_path.h"

namespace lapedit {

/// How the cells of a region move and turn by DetailRotation::LocalGlobal: from the handles' maps to displacements and
/// rotations that have settled. Turns of more than 30 degrees are gone through in steps, so that limbs follow them the
/// way that they came. Deterministic to the bit with CholeskyBackend::Eigen.
class CellTurning {
 public:
  /// Enough for the rotations of any region: 1500 were no better.
  static constexpr int kCells = 400;
  static int wanted_cells(int vertices);

  /// @param region,cells,settings  must outlive the object; blend and rest need not
  /// @param backend  for the cells' own system
  CellTurning(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
              const EditSettings& settings, CholeskyBackend backend, ThreadPool& pool);
  CellTurning(const CellTurning&) = delete;
  CellTurning& operator=(const CellTurning&) = delete;

  /// @param targets  motions of the groups, @param carried  of the components
  /// @param goes_on  may start from the last result, where the way from there is not far: for frames of a drag. Without
  ///                 it the result depends on nothing that came before
  /// Nothing is allocated after the first call.
  void solve(const std::vector<LocalMotion>& targets, const std::vector<LocalMotion>& carried, bool goes_on);

  const Points& displacement() const { return displacement_; }          ///< of the centres, from where they are carried
  const std::vector<Matrix3>& rotations() const { return rotations_; }  ///< likewise
  int passes() const { return passes_; }                                ///< of the last solve()
  double left() const { return left_; }      ///< change of its last pass over the handles' largest way
  double turned() const { return turned_; }  ///< by which that still turned a cell, at most, radians

 private:
  struct Group {
    int component = 0, size = 0;
    Vector3 centre = Vector3::Zero();
  };
  void gather(const Region& region, const Points& rest);
  bool may_go_on(const std::vector<LocalMotion>& targets, const std::vector<LocalMotion>& carried) const;
  double ask(double part);

  const RegionCells& cells_;
  CellSurface surface_;
  CoarseSystem system_;
  std::vector<int> component_;  // of each cell
  std::vector<double> hold_;    // how far its rotation is held back, 0 to 1
  std::vector<Group> groups_;
  LocalGlobal local_global_;
  double size_;
  bool solved_ = false;
  std::vector<LocalMotion> last_targets_;
  std::vector<MotionPath> paths_;
  std::vector<Matrix3> linear_;
  Points carried_, constraints_, displacement_;
  std::vector<Matrix3> rotations_;
  int passes_ = 0;
  double left_ = 0, turned_ = 0;
};

}  // namespace lapedit
