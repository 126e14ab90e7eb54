// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/cell_turning.h"

namespace lapedit {

/// DetailRotation::LocalGlobal for the vertices of a region: the rotations of its cells, blended by quaternions with
/// CellBlend's weights and faded to the identity across the anchor band.
class BlendedRotations {
 public:
  /// @param region,settings  must outlive the object. Cost: O(edges), some milliseconds for each 10000 vertices
  BlendedRotations(const TriangleMesh& mesh, const Region& region, const Points& rest, const EditSettings& settings,
                   ThreadPool& pool);

  CellTurning& cells() { return turning_; }
  const CellTurning& cells() const { return turning_; }
  const CellBlend& blend() const { return blend_; }
  double hold(int i) const { return hold_[i]; }  ///< how far vertex i's rotation is held back, 0 to 1

  /// The cells' last rotations as x y z w, the sign as it comes. @param quaternions  out: one per cell
  void quaternions(std::vector<Eigen::Vector4d>& quaternions) const;

  /// @param rotations  out: one per vertex, of the cells' last. The same bits for any number of threads
  void spread(std::vector<Matrix3>& rotations, ThreadPool& pool);

 private:
  RegionCells cells_;
  CellBlend blend_;
  CellTurning turning_;
  std::vector<double> hold_;
  std::vector<Eigen::Vector4d> quaternions_;
};

}  // namespace lapedit
