// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/base/simd.h"
#include "lapedit/cells/cell_pose.h"
#include "lapedit/deform/rest_pose.h"

namespace lapedit {

/// A region with its handles on some hundred cells: they are posed in milliseconds, whatever the region's size, and the
/// vertices follow them. Scripts and releases take rotations to start from of it, frames of a drag the whole pose. For
/// every setting, region and kind of handle; rotations that are not DetailRotation::None are those of LocalGlobal.
class CellModel {
 public:
  /// @param mesh  rest pose; not kept
  /// Cost: O(edges), some milliseconds for each 10000 vertices. @throws EditError (IllConditioned, Cancelled)
  CellModel(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest, const EditSettings& settings,
            const Progress& progress = {});

  const std::shared_ptr<const RestPose>& rest() const { return rest_; }
  const RegionCells& cells() const { return cells_; }
  const CellPose& pose() const { return pose_; }
  const GroupPaths& paths() const { return paths_; }  ///< of the last solve(), at their end

  /// @param handles,anchors  as for GroupPaths::set()
  /// @param quick            see CellPose::solve()
  /// The result depends on nothing that came before; nothing is allocated after the first call but for targets.
  /// @throws EditError as GroupPaths::set()
  void solve(const std::vector<HandleMotion>& handles, const Affine& anchors, bool quick);
  void solve_in_full();  ///< for the same motions

  /// Rotations of the vertices relative to where they are carried: those of the cells, blended by quaternions and faded
  /// to the identity across the anchor band.
  /// @param rotations  out: one per vertex. The same bits for any number of threads and on every processor
  void spread(std::vector<Matrix3>& rotations, ThreadPool& pool);

  /// How a vertex is turned, in single precision: the columns of T - I, T the linear map of its surroundings with all
  /// that they are carried by, and its place at rest.
  struct Turn {
    Floats4 columns[3];
    Floats4 rest;
  };

  /// About where the vertices go, for a picture, about the rest pose's origin and in model units over `unit`: they
  /// follow the cells with their details turned along (an embedded deformation). A handle is in place by as much as its
  /// weight has to say against the surface's 1.
  /// @param unit          a power of two: of lengths in single precision
  /// @param turns         rest is read; columns are written
  /// @param displacement  out, one more row than vertices: from the rest pose, exactly zero where nothing moves
  void place(double unit, std::vector<Turn>& turns, Points& displacement, ThreadPool& pool);

 private:
  void solve(bool quick);
  /// A cell's pose in single precision.
  struct Placed {
    Floats4 quaternion, way, centre;
  };
  struct Placing;
  void place_handle(int i, double unit, Points& displacement) const;

  std::shared_ptr<const RestPose> rest_;
  EditSettings settings_;
  RegionCells cells_;
  CellBlend blend_;
  CellPose pose_;
  GroupPaths paths_;
  std::vector<double> hold_;  // how far a vertex's rotation is held back, 0 to 1

  std::vector<Eigen::Vector4d> quaternions_;  // of the cells' last pose, x y z w, the sign as it comes
  std::vector<Placed> placed_;
  std::vector<Floats4> carried_;  // of each component three columns
};

}  // namespace lapedit
