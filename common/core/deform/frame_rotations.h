// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/deform/smooth_normals.h"

namespace lapedit {

/// Estimates one rotation per region vertex between two poses by frames (paper, section 4): R takes {n, u, n x u} to
/// {n', u', n' x u'}, where n and n' are smooth normals, and u and u' the unit projections of one edge onto the planes
/// orthogonal to them; of a vertex's edges the one nearest to being orthogonal to n, or those that are equally near.
class FrameRotations {
 public:
  /// @param region,kernel  must outlive the object
  FrameRotations(const Region& region, const SmoothingKernel& kernel) : region_(region), kernel_(kernel) {}

  /// @param before        pose that rotations are measured from, size() x 3. Its normals are kept for the next call
  /// @param displacement  pose after minus pose before
  /// @param rotations     out: one matrix (determinant +1) per vertex; exactly the identity where no vertex nearby
  ///                      moves
  /// Cost: O(kernel entries) + O(edges). Nothing is allocated after the first call.
  void estimate(const Points& before, const Points& displacement, std::vector<Matrix3>& rotations);

 private:
  void smooth(const Points& pose, Points& normals);
  /// Returns the weight of an edge among those that are as tangential as the best, 1 for that, 0 for others.
  double tie(int i, int j, const Vector3& n0, double least) const;
  bool has_moving_tie(int i, const Vector3& n0, double least) const;
  Matrix3 blended_ties(int i, const Vector3& n0, const Vector3& n1, double least, const Matrix3& rotation) const;

  const Region& region_;
  const SmoothingKernel& kernel_;
  Points before_, after_;                  // the poses
  Points normals_before_, normals_after_;  // smooth ones
  bool is_smooth_ = false;                 // normals_before_ are those of before_, which a cancelled pose may not reach
  Points raw_, centres_;
  Eigen::VectorXd areas_;
};

}  // namespace lapedit
