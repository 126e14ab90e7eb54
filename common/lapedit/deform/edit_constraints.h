// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/group_paths.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// Where handles and anchors are to go, and where each component of the region is carried before anything is solved
/// for: with its anchors, or else by the mean of its groups' maps. What is solved for is the displacement from there.
/// Nothing is allocated after the first set() that carries something.
class EditConstraints {
 public:
  /// @param system  must outlive the object
  explicit EditConstraints(const LaplacianSystem& system)
      : system_(system), paths_(system.region, system.rest.local, system.rest.origin) {}

  /// @param handles  one per group, @param anchors  where the anchors go; both in absolute coordinates
  /// @throws EditError as GroupPaths::set()
  void set(const std::vector<HandleMotion>& handles, const Affine& anchors);

  /// w_i^2 (c_i - carried x_i) for handles, size() x 3; 0 elsewhere, since anchors are in place.
  const Points& right_hand_side() const { return right_; }
  /// Whether anything is to move from the carried pose.
  bool pull() const { return pulls_; }

  GroupPaths& paths() { return paths_; }  ///< to be left at their end
  bool carry() const { return carries_; }
  /// The rest pose carried along, about the rest pose's origin; only where carry().
  const Points& carried_pose() const { return carried_pose_; }
  /// Of vertex i's component.
  const LocalMotion& carried(int i) const { return paths_.carried()[system_.region.component[i]]; }
  const Matrix3& carried_rotation(int i) const { return carried_rotation_[system_.region.component[i]]; }

  /// The way of each vertex from the carried pose by the system's fall-off: sum_g phi_g (group g's map - carried).
  /// @param displacement  out: size() x 3
  void fall_off(Points& displacement) const;

  /// c_i - p_i: the way from rest to target of a handle vertex.
  Vector3 wanted_way(int i) const { return paths_.displacement(i); }

 private:
  void carry_along();
  void set_right_hand_side();

  const LaplacianSystem& system_;
  GroupPaths paths_;
  std::vector<Matrix3> carried_rotation_;  // per component
  bool carries_ = false, pulls_ = false;
  Points carried_pose_, right_;
};

}  // namespace lapedit
