// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/base/simd.h"
#include "lapedit/cells/cell_pose.h"
#include "lapedit/cells/rotation_fit.h"
#include "lapedit/deform/rest_pose.h"

namespace lapedit {

/// A coarse model of a region and its handles, with some hundred cells. The cells are posed in milliseconds, whatever
/// the region's size, and the vertices follow them. Scripts and releases start from its rotations; frames of a drag
/// show its pose. It accepts every setting, region and kind of handle, and always has order 1. LocalGlobal computes its
/// rotations; with EditMethod::Linear it has none.
class CellModel {
 public:
  /// @param pool  threads; not kept after construction
  /// Cost: O(edges), some milliseconds per 10000 vertices. @throws EditError (IllConditioned, Cancelled)
  CellModel(std::shared_ptr<const RestPose> rest, const EditSettings& settings, ThreadPool&& pool);

  const std::shared_ptr<const RestPose>& rest() const { return rest_; }
  const RegionCells& cells() const { return cells_; }
  const CellPose& pose() const { return pose_; }
  const GroupPaths& paths() const { return paths_; }  ///< of the last solve(), at their ends

  /// @param handles,anchors  as for GroupPaths::set()
  /// @param quick            see CellPose::solve()
  /// Poses the cells. The result does not depend on earlier calls; after the first call memory is allocated for targets
  /// only.
  /// @throws EditError as GroupPaths::set()
  void solve(const std::vector<HandleMotion>& handles, const Affine& anchors, bool quick);
  void solve(bool quick);  ///< repeats the last solve()

  /// Computes the rotations of the vertices, relative to the rigid motion of their component: those of the cells,
  /// blended as quaternions and faded to the identity across the anchor band.
  /// @param rotations  out: one per vertex, with the same bits for any number of threads and on every processor
  void spread(std::vector<Matrix3>& rotations, ThreadPool& pool);

  /// Computes the rotations of the vertices that fit a pose of the vertices: those of RotationFit, blended by spread().
  /// @param before,displacement  size() x 3: positions, and the pose's distance from them
  /// @param rotations            out: as of spread()
  void fit(const LaplacianSystem& system, const Points& before, const Points& displacement,
           std::vector<Matrix3>& rotations);

  /// The local linear map of a vertex in single precision: the columns of T - I, where T includes the rigid motion of
  /// the component, and the position at rest.
  struct Transform {
    Floats4 columns[3];
    Floats4 rest;
  };

  /// Approximates the displacements of the vertices for a picture, relative to the rest pose's origin and in model
  /// units over `unit`: vertices follow the cells, and details rotate with them (an embedded deformation). A handle
  /// vertex lies between the cells' pose and its target, according to its weight against the surface's weight of 1.
  /// @param unit          a power of two, the unit of lengths in single precision
  /// @param transforms       one per vertex: `rest` is read, `columns` are written
  /// @param displacement  out, one more row than vertices: displacements from the rest pose, exactly zero where nothing
  ///                      moves
  void displace(double unit, Transform* transforms, Points& displacement, ThreadPool& pool);

 private:
  /// The pose of a cell in single precision.
  struct PosedCell {
    Floats4 quaternion, moved, centre;
  };
  struct Displacing;
  void displace_handle(int i, double unit, Points& displacement) const;
  void displace_hanging(double unit, Transform* transforms, Points& displacement) const;

  std::shared_ptr<const RestPose> rest_;
  EditSettings settings_;
  RegionCells cells_;
  CellBlend blend_;
  CellPose pose_;
  GroupPaths paths_;
  std::vector<double> hold_;  // per vertex: 0 keeps its rotation, 1 replaces it by the identity

  RotationFit fit_;
  std::vector<Eigen::Vector4d> quaternions_;  // of the cells' last pose, x y z w, with either sign
  std::vector<PosedCell> posed_;
  std::vector<Floats4> rigid_columns_;  // three columns per component
};

}  // namespace lapedit
