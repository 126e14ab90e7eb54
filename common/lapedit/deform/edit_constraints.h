// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/group_paths.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// Targets of handles and anchors, and the rigid motion of each component of the region before the solve: that of its
/// anchors, or the mean of its groups' maps if it has none. The solve computes displacements from the moved ("carried")
/// pose. Nothing is allocated after the first set() that moves a component.
class EditConstraints {
 public:
  /// @param system  must outlive the object
  explicit EditConstraints(const LaplacianSystem& system)
      : system_(system), paths_(system.region, system.rest.local, system.rest.origin) {}

  /// @param handles  one per group, @param anchors motion of the anchors; both in absolute coordinates
  /// @throws EditError as GroupPaths::set()
  void set(const std::vector<HandleMotion>& handles, const Affine& anchors);

  /// Returns w_i^2 (c_i - carried x_i) for handle vertices, size() x 3; 0 elsewhere, since anchors are at their
  /// targets.
  const Points& right_hand_side() const { return right_; }
  /// Returns whether any target differs from the carried pose.
  bool pull() const { return pulls_; }

  GroupPaths& paths() { return paths_; }  ///< callers must leave them at their ends
  bool carry() const { return carries_; }
  /// Returns the carried pose, relative to the rest pose's origin. Defined only if carry().
  const Points& carried_pose() const { return carried_pose_; }
  /// Returns the rigid motion of the component of vertex i.
  const LocalMotion& carried(int i) const { return paths_.carried()[system_.region.component[i]]; }
  const Matrix3& carried_rotation(int i) const { return carried_rotation_[system_.region.component[i]]; }

  /// Computes displacements from the carried pose by the system's fall-off: sum_g phi_g (group g's map - carried).
  /// @param displacement  out: size() x 3
  void fall_off(Points& displacement) const;

  /// Returns c_i - p_i, the displacement of a handle vertex from rest to target.
  Vector3 wanted_way(int i) const { return paths_.displacement(i); }

 private:
  const LaplacianSystem& system_;
  GroupPaths paths_;
  std::vector<Matrix3> carried_rotation_;  // per component
  bool carries_ = false, pulls_ = false;
  Points carried_pose_, right_;
};

}  // namespace lapedit
