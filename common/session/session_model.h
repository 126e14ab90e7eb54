// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/edit/edit.h"
#include "lapedit/edit/mirror.h"
#include "lapedit/mesh/region.h"
#include "lapedit/session/gizmo.h"
#include "lapedit/session/hover.h"
#include "lapedit/session/snap.h"

namespace lapedit {

/// The whole path of the handles of a step, where the step takes a fraction of it.
struct StepPath {
  std::vector<HandleGroup> whole;
  std::vector<int> moved;  ///< those that the user moved, ascending
  double fraction = 1;
};

/// A step with its changes.
struct AppliedStep {
  EditStep step;
  std::vector<int> vertices;  ///< mesh vertex numbers
  Points before, after;       ///< one row per entry of vertices
  StepPath path;
};

/// Returns the handles at a fraction from 0 to 1 of their path. @param rest  the mesh before the step
std::vector<HandleGroup> path_fraction(const StepPath& path, const TriangleMesh& rest);
/// Returns the path of a step that takes all of it.
StepPath path_of(const EditStep& step);

/// A mesh and the steps applied to it. Undo restores stored positions, so it is exact to the bit.
///
/// A step, an undo or a redo changes a copy of the mesh if mesh() has given it to others, since other threads may be
/// reading it. References last until the next change.
class History {
 public:
  explicit History(TriangleMesh original);

  const TriangleMesh& original() const { return *original_; }
  const TriangleMesh& current() const { return *mesh_; }
  /// Returns current() for others, which may keep it: it never changes.
  std::shared_ptr<const TriangleMesh> mesh() const {
    is_shared_ = true;
    return mesh_;
  }
  /// Returns the mesh before the last step. There has to be one.
  std::shared_ptr<const TriangleMesh> before_last() const;
  const std::vector<AppliedStep>& steps() const { return steps_; }  ///< applied, the oldest first
  bool can_undo() const { return !steps_.empty(); }
  bool can_redo() const { return !undone_.empty(); }
  /// Returns the steps with counts and connectivity of the mesh: applied to original() by apply_edit() they give
  /// current().
  Edit recorded() const;

  /// Applies a step that was solved, and deletes undone steps. @param after  one row per vertex
  /// @param path  none: the step takes all of it
  const AppliedStep& apply(EditStep step, std::vector<int> vertices, Points after, std::optional<StepPath> path = {});
  /// Undoes the last step. There has to be one. @return the step
  const AppliedStep& undo();
  /// Redoes the step that was undone last. There has to be one. @return the step
  const AppliedStep& redo();
  /// Changes the faces of current() and of the meshes that follow it.
  void set_faces(Faces faces);

 private:
  void change(const std::vector<int>& vertices, const Points& positions);

  std::shared_ptr<TriangleMesh> mesh_;
  std::shared_ptr<const TriangleMesh> original_;
  mutable bool is_shared_ = true;  // mesh_ must not change
  std::vector<AppliedStep> steps_, undone_;
  mutable std::string checksum_;  // of the connectivity; empty until recorded() needs it
};

/// The centre of rotation and scale.
enum class Pivot {
  Centroid,  ///< of the active group
  Boundary,  ///< the middle of the region's boundary on the group's piece: the shoulder of an arm
  Point      ///< a picked vertex; it moves with the surface
};

/// The functions that a session calls.
struct SessionCallbacks {
  /// Receives a line for a log: a step was applied, undone, refused.
  std::function<void(const std::string&)> log;
  /// Called on the worker's thread: the caller should then call poll() on its own thread.
  std::function<void()> wake;
  /// Called when a translation begins, unless snapping is off.
  FindTargets find_targets = {};
};

/// New positions of some vertices of the mesh.
struct PoseChange {
  std::vector<int> vertices;  ///< mesh vertex numbers, ascending
  Points positions;           ///< one row per vertex
  bool settled = false;       ///< applied or undone steps are among them; otherwise it is a passing pose
};

/// The user's switches, read and set as a whole.
struct Tools {
  std::optional<BrushTarget> paint = {};  ///< painted without a modifier; none: the brush paints the region, with one
  bool gizmo = false;
  bool gizmo_by_click = false;  ///< the gizmo is hidden when another handle is picked
  GizmoAxes axes = GizmoAxes::Layer;
  Pivot pivot = Pivot::Centroid;           ///< Point: the next click picks it
  bool snaps = false;                      ///< a moved handle snaps to the surfaces of FindTargets
  std::optional<MirrorPlane> mirror = {};  ///< mirrors every step; none: off
};

/// The switches with their state.
struct ToolState : Tools {
  int pivot_vertex = -1;                            ///< Pivot::Point; -1: the next click picks it
  std::shared_ptr<const SnapTargets> targets;       ///< null: none
  std::unique_ptr<const MirroredHandles> mirrored;  ///< of the groups; null without a plane and while they are painted

  BrushTarget brush() const { return paint.value_or(BrushTarget::Region); }
  bool awaits_pivot() const { return pivot == Pivot::Point && pivot_vertex < 0; }
};

/// One action that undo() reverses: a step of the history, or a stroke of the brush.
struct Action {
  std::string name;  ///< for a list
  bool is_step;
  Selection before;
  Selection after = {};  ///< of a stroke: set when it is undone
};

/// All actions in their order.
class Timeline {
 public:
  const std::vector<Action>& done() const { return done_; }      ///< the oldest first
  const std::vector<Action>& undone() const { return undone_; }  ///< the last one is the next to redo
  /// Adds an action and deletes the undone ones.
  void add(Action action) {
    done_.push_back(std::move(action));
    change_last();
  }
  /// Returns the last action to be changed. There has to be one. Deletes the undone actions, since they followed its
  /// former state.
  Action& change_last() {
    undone_.clear();
    ++serial_;
    return done_.back();
  }
  /// Moves the last action of one list, which must not be empty, to the other. @return it
  Action& undo() { return move_last(done_, undone_); }
  Action& redo() { return move_last(undone_, done_); }
  int serial() const { return serial_; }  ///< counts the changes of both lists

 private:
  Action& move_last(std::vector<Action>& from, std::vector<Action>& to) {
    to.push_back(std::move(from.back()));
    from.pop_back();
    ++serial_;
    return to.back();
  }

  std::vector<Action> done_, undone_;
  int serial_ = 0;
};

/// The shown region and its pose.
class ShownRegion {
 public:
  /// Shows a region as it is in the mesh; null: none.
  void show(std::shared_ptr<const Region> region, const TriangleMesh& mesh);
  /// Stores a region that is shown together with its first pose; until then the old one stays.
  void await(std::shared_ptr<const Region> region) { awaited_ = std::move(region); }
  std::shared_ptr<const Region> take_awaited() { return std::move(awaited_); }
  /// Shows a pose that differs from the mesh, swapping it with the old one. Allocates nothing.
  void pose(Points& positions);
  /// Records that the shown pose has become the mesh.
  void settle();
  /// Shows the mesh again. @return whether the pose was another one
  bool rest(const TriangleMesh& mesh);

  const std::shared_ptr<const Region>& region() const { return region_; }
  const Points& pose() const { return pose_; }  ///< one row per vertex of the region
  int serial() const { return serial_; }        ///< counts the changes of region() and pose()
  int region_serial() const { return region_serial_; }
  /// Returns the number of vertices of a class, 0 without a region.
  int count(VertexClass c) const { return counts_[static_cast<int>(c)]; }
  /// Returns the number of vertices in pieces that a single handle would move rigidly, since nothing else holds them.
  int held_by_nothing() const { return held_by_nothing_; }
  bool away() const { return away_; }  ///< the pose differs from the mesh

 private:
  std::shared_ptr<const Region> region_, awaited_;
  Points pose_;
  int counts_[4] = {};
  int held_by_nothing_ = 0;
  int serial_ = 0, region_serial_ = 0;
  bool away_ = false;
};

/// The state of a session: the mesh with its steps, selection and switches, and what is shown of it.
struct SessionModel {
  StoredScalar scalar;
  History history;
  std::shared_ptr<const Adjacency> given_adjacency, adjacency;  ///< of history.original(), and of mesh()
  Weld weld;                                                    ///< of mesh(), whose faces are on representatives
  std::function<void(const std::string&)> log;
  FindTargets find_targets;  ///< may be empty
  DragSettings settings;
  Selection selection;
  ToolState tools;
  Timeline timeline;
  std::string refusal;
  ShownRegion shown;
  int others = 0;                ///< number of further vertices at the positions of the shown region's
  std::vector<int> unconnected;  ///< of the selection's vertices, ascending
  HoverBackground background;

  /// @throws EditError as validate()
  SessionModel(TriangleMesh mesh, StoredScalar stored, const SessionCallbacks& callbacks);

  const TriangleMesh& mesh() const { return history.current(); }
  /// Returns the search for the surface under the cursor, null until it is ready.
  HoverSearch* search() { return background.of(history.mesh(), adjacency); }
  /// Returns the mesh with the faces of the original.
  std::shared_ptr<const TriangleMesh> given_mesh() const;
  /// Returns a pose with all other vertices at the positions of its vertices.
  EditResult with_others(const std::vector<int>& vertices, const Points& positions) const;
  const std::vector<std::vector<int>>& groups() const { return selection.groups; }
  /// Returns the groups, followed by their mirror images.
  const std::vector<std::vector<int>>& all_groups() const {
    return tools.mirrored ? tools.mirrored->groups() : groups();
  }
  bool has_active_group() const { return !groups().empty() && selection.active >= 0; }
  const std::vector<int>& active_group() const { return groups()[selection.active]; }
  Vector3 center() const;          ///< of all groups that move. Allocates nothing
  Vector3 pivot_position() const;  ///< the centre of rotation and scale
  std::optional<Gizmo> gizmo(const Camera& view) const;

  /// Makes a choice the selection, or reports why not. @return whether it was accepted
  bool take(Choice choice);

  /// Notes new positions for take_change(). Allocates nothing for the vertices of the last change.
  void show(const std::vector<int>& vertices, const Points& positions, bool settled);
  void show_region(std::shared_ptr<const Region> region);
  /// Shows a painted region before its distances are known.
  void show_by_hand();
  void back_to_mesh(bool settled);
  /// Undoes the last action of the timeline, or redoes the one undone last. @return whether it was a step
  bool undo();
  bool redo();
  const PoseChange* take_change();

 private:
  PoseChange change_;
  std::vector<int> shown_, rows_;  // the vertices shown last, and the index in them of each vertex of change_
  bool changed_ = false;           // since the last take_change()
};

}  // namespace lapedit
