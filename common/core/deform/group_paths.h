// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// The paths of all handle groups of a region, and the rigid motions of its components before the solve. A component
/// with anchors has none; without anchors it moves with its groups if all of them move alike, or else by the rigid
/// motion that fits the positions of all its handle vertices best. Scripts, drags and releases follow the same steps of
/// these paths, so that a limb buckles to the same side in all of them.
class GroupPaths {
 public:
  /// @param rest    rest pose relative to `origin`, size() x 3; region and rest must outlive the object
  GroupPaths(const Region& region, const Points& rest, const Vector3& origin);

  /// Sets one motion per group, and moves the groups to the ends of their paths. A group of one vertex has a
  /// displacement, but no rotation and no scale. After the first call memory is allocated for targets of vertices only.
  /// @throws EditError (NoHandle, NotFinite, BadParameter) unless there is a finite motion for each group, with no
  ///         targets or one for each vertex
  void set(const std::vector<HandleMotion>& motions);

  /// Returns the number of equal steps of the paths. A step is at most 30 degrees of rotation, a tenth of the region's
  /// size or a stretch of a quarter, unless the path is very long.
  int steps() const { return steps_; }
  /// Moves all groups to the end of a step, 0 (rest) to steps().
  void go_to(int step);

  /// Returns the displacement of handle vertex i of the region at the end of the step.
  Vector3 displacement(int i) const;
  /// Returns the same for a position in a group.
  /// @param offset  mean of target_offset() over the vertices that the position represents
  Vector3 displacement(int group, const Vector3& position, const Vector3& offset) const;
  /// Returns the vector from the position of handle vertex i after its group's motion to its target, in coordinates
  /// that rotate with the group.
  Vector3 target_offset(int i) const;
  bool has_targets() const { return has_targets_; }  ///< of single vertices, in any group
  bool stays(std::size_t group) const;               ///< whether the group has no motion, at any fraction
  double degrees(std::size_t group) const;           ///< of its rotation in this edit, with its revolutions
  bool mirrors(std::size_t group) const;             ///< whether its map mirrors
  const std::vector<LocalMotion>& motions() const { return motions_; }  ///< of the groups; without target_offset()

  const std::vector<LocalMotion>& rigid_motions() const { return rigid_motions_; }  ///< of the components
  const std::vector<Matrix3>& rotations() const { return rotations_; }              ///< of motions()
  const std::vector<Matrix3>& rigid_rotations() const { return rigid_rotations_; }
  bool moves_rigidly() const;  ///< whether any component is moved
  bool revolves() const;       ///< whether any group makes a revolution, after which it may be where it was

  /// Returns the hanging vertices: free vertices that a single group connects to everything that is held, and that move
  /// rigidly with it. Groups whose vertices are on a line have none, since a surface can rotate about a line.
  const std::vector<int>& hanging() const { return hanging_; }
  /// Returns the group that a hanging vertex moves with; -1 if the group's vertices have targets.
  int followed(int hanging) const { return groups_[index_[hanging]].offsets.rows() == 0 ? index_[hanging] : -1; }
  /// Gives hanging vertices the rotation of their group, relative to the rigid motion of their component, and the
  /// vertices of components that follow their groups none.
  void rotate_hanging(std::vector<Matrix3>& rotations) const;

 private:
  struct Group {
    std::vector<int> vertices;  // of the region, ascending
    Vector3 centre = Vector3::Zero();
    std::vector<int> components;  // of the region, that it has vertices in
    MotionPath path;
    double fraction = 1, now = 1;  // fractions of the path: its end in this edit, and the current position
    Points offsets;                // of the vertices' targets; or no rows
  };
  void check(const std::vector<HandleMotion>& motions) const;
  void set_targets(Group& group, const HandleMotion& motion);
  void lead(int g, int& leader) const;
  bool is_wide(const Group& group) const;
  void find_hanging();
  LocalMotion after(const Group& group, double fraction) const;
  LocalMotion best_fit(int component) const;

  const Region& region_;
  const Points& rest_;
  Vector3 origin_;
  std::vector<Group> groups_;
  std::vector<int> index_;              // of a handle vertex in its group; of the group for a hanging vertex
  std::vector<int> hanging_;            // ascending
  std::vector<std::vector<int>> held_;  // per component without anchors: its handle vertices, by groups
  std::vector<int> unanchored_;         // the other vertices of components without anchors, ascending
  std::vector<LocalMotion> motions_, rigid_motions_;
  std::vector<Matrix3> rotations_, rigid_rotations_;
  std::vector<int> leader_;  // per component: a group that all its groups move like, kSeveral or kNoGroup
  int steps_ = 1;
  bool has_targets_ = false;
};

}  // namespace lapedit
