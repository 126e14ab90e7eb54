// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// A map x -> L x + t as "minus identity", about a local origin: keeps a translation of a far-away mesh exact.
struct LocalMotion {
  Matrix3 linear = Matrix3::Zero();       ///< L - I
  Vector3 translation = Vector3::Zero();  ///< displacement of the local origin

  static LocalMotion of(const Affine& map, const Vector3& origin);
  Vector3 displacement(const Vector3& local) const { return linear * local + translation; }
  bool none() const { return linear.isZero(0) && translation.isZero(0); }
};

/// @throws EditError (NoHandle, NotFinite) unless there is a finite map for each of the region's handle groups
void check_targets(const Region& region, const std::vector<Affine>& handles);

/// Scratch of carry_components(), per component.
struct HandlesSeen {
  int count = 0, first_group = -1;
  bool agree = true;  ///< whether all groups turn and stretch alike
};

/// Where each component of a region is carried before anything is solved for: with its anchors, or else by the mean of
/// its groups' maps, in which rotations stay rotations. A linear mean (EditSettings::rules 1) of groups that turn by
/// different angles shrinks what is between them.
/// @param rest  size() x 3, about the origin of the motions. Nothing is allocated after the first call.
void carry_components(const Region& region, const Points& rest, const std::vector<LocalMotion>& targets,
                      const LocalMotion& anchors, int rules, std::vector<LocalMotion>& carried,
                      std::vector<HandlesSeen>& seen);

/// Where handles and anchors are to go, and where each component of the region is carried before anything is solved
/// for: with its anchors, or else by the mean of its groups' maps. What is solved for is the displacement from there.
/// Nothing is allocated after the first set() that carries something.
class EditConstraints {
 public:
  /// @param system  must outlive the object
  explicit EditConstraints(const LaplacianSystem& system) : system_(system) {}

  /// @param handles  one map per group, @param anchors  where the anchors go; both in absolute coordinates
  void set(const std::vector<Affine>& handles, const Affine& anchors);

  /// w_i^2 (c_i - carried x_i) for handles, size() x 3; 0 elsewhere, since anchors are in place.
  const Points& right_hand_side() const { return right_; }
  /// Whether anything is to move from the carried pose.
  bool pull() const { return pulls_; }

  bool carry() const { return carries_; }
  /// The rest pose carried along, about the rest pose's origin; only where carry().
  const Points& carried_pose() const { return carried_pose_; }
  /// Of vertex i's component.
  const LocalMotion& carried(int i) const { return carried_[system_.region.component[i]]; }
  const Matrix3& carried_rotation(int i) const { return carried_rotation_[system_.region.component[i]]; }

  /// The way of each vertex from the carried pose by the system's fall-off: sum_g phi_g (group g's map - carried).
  /// @param displacement  out: size() x 3
  void fall_off(Points& displacement) const;

  /// c_i - p_i: the way from rest to target of a handle vertex.
  Vector3 wanted_way(int i) const;
  std::size_t bytes() const;

 private:
  void carry_along(const Affine& anchors);
  void set_right_hand_side();

  const LaplacianSystem& system_;
  std::vector<LocalMotion> targets_;       // per handle group
  std::vector<LocalMotion> carried_;       // per component
  std::vector<Matrix3> carried_rotation_;  // per component
  std::vector<HandlesSeen> handles_seen_;  // per component
  bool carries_ = false, pulls_ = false;
  Points carried_pose_, right_;
};

}  // namespace lapedit
