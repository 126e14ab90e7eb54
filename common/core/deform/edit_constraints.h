// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/deform/geodesic_falloff.h"
#include "lapedit/deform/group_paths.h"
#include "lapedit/deform/rest_pose.h"

namespace lapedit {

/// Targets of handles and anchors, and the rigid motion of each component of the region before the solve: none, or the
/// mean of its groups' maps if it has no anchors. The solve computes displacements from the rigidly moved
/// pose. Nothing is allocated after the first set() that moves a component.
class EditConstraints {
 public:
  /// @param rest  must outlive the object
  explicit EditConstraints(const RestPose& rest);

  /// @param handles  one per group, in absolute coordinates
  /// @param shift    displacement of the rest pose that start() begins with, size() x 3; or no rows. Handles move
  ///                 relative to it
  /// @throws EditError as GroupPaths::set()
  void set(const std::vector<HandleMotion>& handles, const Points& shift = {});

  /// Returns c_i - q_i for a handle vertex with the target c_i, size() x 3, where q is the rigidly moved pose; 0 for
  /// all others, since anchors of q are at their targets.
  const Points& wanted() const { return wanted_; }
  const std::vector<int>& handles() const { return handles_; }  ///< vertices of the region, ascending
  /// Returns whether any target differs from the rigidly moved pose.
  bool any() const { return any_; }

  const GroupPaths& paths() const { return paths_; }
  GroupPaths& paths() { return paths_; }  ///< to be left at their ends
  bool moves_rigidly() const { return moves_rigidly_; }
  bool starts_elsewhere() const { return moves_rigidly_ || shift_.rows() > 0; }
  /// Returns the pose that the solve starts from, relative to the rest pose's origin: shifted, and rigidly moved if a
  /// component moves.
  const Points& start() const { return starts_elsewhere() ? start_ : rest_.local; }
  /// Returns the displacement of vertex i from the rest pose to start().
  Vector3 start_displacement(int i) const;
  /// Returns the rigid motion of the component of vertex i.
  const LocalMotion& rigid_motion(int i) const { return paths_.rigid_motions()[region_.component[i]]; }
  const Matrix3& rigid_rotation(int i) const { return paths_.rigid_rotations()[region_.component[i]]; }

  /// Computes displacements from start() by a fall-off: sum_g phi_g (group g's map - rigid motion).
  /// @param displacement  out: size() x 3
  void fall_off(const GeodesicFalloff& falloff, Points& displacement, ThreadPool& pool) const;

  /// Returns c_i - p_i, the displacement of a handle vertex from rest to target.
  Vector3 wanted_displacement(int i) const { return paths_.displacement(i); }

 private:
  const RestPose& rest_;
  const Region& region_;
  GroupPaths paths_;
  std::vector<int> handles_;
  bool moves_rigidly_ = false, any_ = false;
  Points shift_, start_, wanted_;
};

}  // namespace lapedit
