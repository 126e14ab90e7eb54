// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/polar_decomposition.h"
#include "lapedit/deform/smooth_normals.h"

namespace lapedit {

/// How differential coordinates turn with the surface.
enum class DetailRotation {
  None,           ///< they do not
  SmoothNormals,  ///< the paper's frames: a smooth normal and the most tangential edge (section 4)
  SmoothSurface,  ///< rotations fitted to the smoothed surface
  LocalGlobal     ///< those of the region's cells, until local and global steps change nothing: see CellTurning
};

const char* name(DetailRotation rotation);

/// How often fitted covariances are averaged over the one-ring.
constexpr int kAveragingPasses = 4;

/// SmoothSurface: with P0 and P1 the smoothed positions before and after, n0 and n1 the vertex normals of those
/// surfaces, C = sum over a vertex's edges of (P1_j - P1_i)(P0_j - P0_i)^T + |.|_F n1 n0^T, averaged over the one-ring
/// four times over; the rotation nearest to it, faded to the identity across the anchor band. Source: this project; the
/// averaging also settles what thin limbs leave open.
///
/// Estimates one rotation per region vertex between two poses. Made once per region; nothing is allocated after the
/// first estimate().
class RotationEstimator {
 public:
  /// @param smoother  smoothing for both kinds; must outlive the object, as must region and pool
  RotationEstimator(DetailRotation kind, const Region& region, const Smoother& smoother, ThreadPool& pool);

  /// Sets the pose to turn from, size() x 3.
  void set_before(const Points& before);
  /// The same by its smoothed positions, for SmoothSurface.
  void set_before_smoothed(const Points& smoothed);

  /// @param displacement  size() x 3, pose after minus pose before
  /// @param rotations     one matrix (determinant +1) per vertex; exactly the identity where nothing near it moves
  /// Cost: O(kernel entries) + O(edges).
  void estimate(const Points& displacement, std::vector<Matrix3>& rotations);

  double normals_ms() const { return normals_ms_; }  ///< smoothing share of the last estimate()
  double rotate_ms() const { return rotate_ms_; }    ///< fitting share of the last estimate()

 private:
  template <class Body>
  void for_vertices(const Body& body);
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
