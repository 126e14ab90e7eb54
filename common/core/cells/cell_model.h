// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/base/simd.h"
#include "lapedit/cells/cell_pose.h"
#include "lapedit/cells/rotation_fit.h"
#include "lapedit/deform/edit_constraints.h"

namespace lapedit {

/// A coarse model of a region and its handles, with some hundred cells. The cells are posed in milliseconds, whatever
/// the region's size, and the vertices follow them. Every pose of EditMethod::Default and every frame of a drag starts
/// from it. It accepts every setting, region and kind of handle, and always has order 1. LocalGlobal computes its
/// rotations; with EditMethod::Linear it has none.
class CellModel {
 public:
  /// @param pool  threads; not kept after construction
  /// Cost: O(edges), some milliseconds per 10000 vertices. @throws EditError (IllConditioned, Cancelled)
  CellModel(std::shared_ptr<const RestPose> rest, const EditSettings& settings, ThreadPool&& pool);

  const std::shared_ptr<const RestPose>& rest() const { return rest_; }
  const RegionCells& cells() const { return cells_; }
  const CellPose& pose() const { return pose_; }

  /// Poses the cells. The result does not depend on earlier calls, and nothing is allocated after the first one.
  /// @param paths  of the region's groups, at their ends before and after the call
  /// @param quick  see CellPose::solve()
  void solve(GroupPaths& paths, bool quick);

  /// Spreads the last pose over the vertices. Rotations are those of the cells, blended as quaternions and faded to the
  /// identity across the anchor band. Vertices follow the cells, and details rotate with them (an embedded
  /// deformation); a handle vertex lies between the cells' pose and its target, according to its weight against the
  /// surface's weight of 1. Both are relative to the rigid motion of the component, and the identity and exactly zero
  /// where nothing moves.
  /// @param constraints   with the paths of the last solve()
  /// @param rotations     out: one per vertex. @param displacement  out: size() x 3
  /// The bits are the same for any number of threads.
  void spread(const EditConstraints& constraints, std::vector<Matrix3>& rotations, Points& displacement,
              ThreadPool& pool);

  /// Computes the rotations of the vertices that fit a pose of the vertices: those of RotationFit, blended by spread().
  /// @param displacement  size() x 3: the pose's distance from constraints.start()
  /// @param rotations     out: as of spread()
  void fit(const LaplacianSystem& system, const EditConstraints& constraints, const Points& displacement,
           std::vector<Matrix3>& rotations);

 private:
  struct PosedCell {
    Doubles4 quaternion, moved;  ///< x y z w, with either sign; displacement of the centre
  };
  struct Blend;
  void blend(const EditConstraints& constraints, std::vector<Matrix3>& rotations, Points* displacement,
             ThreadPool& pool);

  std::shared_ptr<const RestPose> rest_;
  EditSettings settings_;
  RegionCells cells_;
  CellBlend blend_;
  CellPose pose_;
  std::vector<double> hold_;  // per vertex: 0 keeps its rotation, 1 replaces it by the identity
  RotationFit fit_;
  std::unique_ptr<PosedCell[]> posed_;
  Points detail_;  // p_i - sum_k w_k C_k per vertex, with the blend's weights of the cells' centres C_k
};

}  // namespace lapedit
