// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/ring_rotations.h"

namespace lapedit {

/// Steps 2 and 3 of the paper's section 4: estimates local rotations R_i of an unrotated or earlier result, and rotates
/// the differential coordinates. Nothing is allocated after the first pass.
class RotationPass {
 public:
  /// @param system  must outlive the object. Cost: one smoothing, if there is a smoother
  explicit RotationPass(const LaplacianSystem& system);

  /// Sets the pose that rotations are measured from: the carried pose (see EditConstraints), or the rest pose.
  void start(const EditConstraints& constraints);

  /// @param displacement  from that pose, size() x 3
  /// @param rotations     R_i, one per vertex
  /// @param right         out: w^2-weighted constraints + M^T M_1^(k-1) (R - I) delta, k the order
  void turn(const Points& displacement, const EditConstraints& constraints, std::vector<Matrix3>& rotations,
            Points& right);

  /// Does the same with given rotations. @param rotations relative to the carried pose
  void turn_by(const std::vector<Matrix3>& rotations, const EditConstraints& constraints, Points& right);
  /// Does the same with rotations fitted to the one-rings of the last pose, for DetailRotation::LocalGlobal.
  void turn_with_rings(const Points& displacement, const EditConstraints& constraints, std::vector<Matrix3>& rotations,
                       Points& right);

  double normals_ms() const {
    return estimator_ ? estimator_->normals_ms() : 0;
  }                                                ///< time of smoothing in the last turn()
  double rotate_ms() const { return rotate_ms_; }  ///< time of the rest of it

 private:
  void start_at_rest();
  const LaplacianSystem& system_;
  std::unique_ptr<Smoother> smoother_;
  std::unique_ptr<RotationEstimator> estimator_;
  std::unique_ptr<RingRotations> rings_;  // made on first use
  bool at_rest_ = false;
  Points smooth_rest_;
  Points turned_, between_;
  double rotate_ms_ = 0;
};

}  // namespace lapedit
