// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/polar_decomposition.h"
#include "lapedit/deform/smooth_normals.h"

namespace lapedit {

/// How differential coordinates rotate with the surface.
enum class DetailRotation {
  None,           ///< no rotation
  SmoothNormals,  ///< the paper's frames: a smooth normal and the most tangential edge (section 4)
  SmoothSurface,  ///< rotations fitted to the smoothed surface
  LocalGlobal     ///< fitted and solved for in turns, on cells and then on vertices: see LocalGlobal, RingRotations
};

const char* name(DetailRotation rotation);

/// Estimates one rotation per region vertex between two poses. Those of SmoothSurface are nearest to the averaged
/// covariances of the smoothed surface's edges and normals, faded to the identity across the anchor band (source: this
/// project). Construct it once per region; nothing is allocated after the first estimate().
class RotationEstimator {
 public:
  /// @param smoother  smoothing for both kinds; smoother, region and pool must outlive the object
  RotationEstimator(DetailRotation kind, const Region& region, const Smoother& smoother, ThreadPool& pool);

  /// Sets the pose that rotations are measured from, size() x 3.
  void set_before(const Points& before);
  /// Sets the smoothed positions of that pose, for SmoothSurface.
  void set_before_smoothed(const Points& smoothed);

  /// @param displacement  size() x 3, pose after minus pose before
  /// @param rotations     out: one matrix (determinant +1) per vertex; exactly the identity where no vertex nearby
  ///                      moves
  /// Cost: O(kernel entries) + O(edges).
  void estimate(const Points& displacement, std::vector<Matrix3>& rotations);

  double normals_ms() const { return normals_ms_; }  ///< time of smoothing in the last estimate()
  double rotate_ms() const { return rotate_ms_; }    ///< time of fitting in the last estimate()

 private:
  void paper_frames(std::vector<Matrix3>& rotations);
  void smooth_surface(std::vector<Matrix3>& rotations);

  DetailRotation kind_;
  const Region& region_;
  const Smoother& smoother_;
  ThreadPool& pool_;
  Points before_, after_;                  // the poses
  Points smooth_before_, smooth_after_;    // smoothed positions (SmoothSurface) or smoothed normals (SmoothNormals)
  Points normals_before_, normals_after_;  // vertex normals of the smoothed poses (SmoothSurface)
  Points scratch_;
  Eigen::VectorXd areas_;
  std::vector<Matrix3> covariances_, spread_;
  double normals_ms_ = 0;
  double rotate_ms_ = 0;
};

}  // namespace lapedit
