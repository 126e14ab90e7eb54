// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/session/drag_key.h"
#include "lapedit/session/session_model.h"
#include "lapedit/session/session_mouse.h"
#include "lapedit/session/session_solver.h"

// From a click to a saved edit, as a window does it (here with wait() instead of an event loop):
//
//   DragSession session(mesh, StoredScalar::Float, callbacks);
//   session.press({camera, pixel});                        // picks a handle, and a region around it
//   session.move({camera, pixel + Vector2(40, 0)});        // poll() and take_change(): the surface
//   session.release({camera, pixel + Vector2(40, 0)});
//   session.wait();                                        // session.mesh() is the edited mesh
//   const Edit edit = session.recorded();                  // for apply_edit(), or to be written as JSON

namespace lapedit {

/// What a later session with the same mesh, or with one that other code has changed, takes over. Its size depends on
/// steps and painted vertices only.
struct Inheritance {
  Tools tools;
  DragSettings settings;
  Edit saved;         ///< see DragSession::saved()
  Edit recorded;      ///< steps that cannot be undone any more; counts and connectivity of the mesh
  Selection painted;  ///< see DragSession::keep_painted(); for a mesh with the same faces
};

/// One dragging session with one mesh: the interactive tool without its window.
///
/// Takes mouse and keys, returns poses. No function waits: a worker thread prepares regions and solves for poses,
/// poll() takes the results, and take_change() returns the vertices that have moved. Each release applies one EditStep
/// to the mesh. recorded() returns all steps: apply_edit() with them on original() gives mesh() bit for bit. User input
/// never makes a function throw: message() reports refusals.
class DragSession {
 public:
  enum class State {
    Idle,      ///< no handle
    Picked,    ///< a handle; its region is shown as soon as it is known
    Dragging,  ///< the handle follows the mouse or typed numbers
    Settling   ///< released: the exact result is being computed
  };

  using Callbacks = SessionCallbacks;

  /// @param mesh    the mesh at the beginning
  /// @param scalar  precision of the mesh that takes the poses
  /// @throws EditError (EmptyMesh, BadIndex) as validate()
  DragSession(TriangleMesh mesh, StoredScalar scalar, const Callbacks& callbacks);
  DragSession(const DragSession&) = delete;
  DragSession& operator=(const DragSession&) = delete;

  // What is shown ---------------------------------------------------------------------------------------------

  State state() const;
  const TriangleMesh& original() const { return model_.history.original(); }
  /// With all applied steps, without a drag in progress; of vertices at the same place only the first has faces.
  const TriangleMesh& mesh() const { return model_.mesh(); }
  const Adjacency& adjacency() const { return *model_.adjacency; }              ///< of mesh()
  const Adjacency& given_adjacency() const { return *model_.given_adjacency; }  ///< of original()
  const ShownRegion& shown() const { return model_.shown; }  ///< the classified region to show, and its pose
  const Selection& selection() const { return model_.selection; }
  /// Returns the groups, each merged with its mirror image where they touch, followed by the other images.
  const std::vector<std::vector<int>>& mirrored_groups() const { return model_.all_groups(); }
  int group_of_image(
      int group) const;       ///< index in selection().groups of the group or image with an index in mirrored_groups()
  Affine active_map() const;  ///< the map of the active group in the drag, also before a pose is solved
  const DragMotion* motion() const;  ///< the drag in progress, null if there is none
  Preparation preparation() const { return solver_.preparation(); }
  /// Returns whether poll() has, or will have, something new.
  bool busy() { return solver_.worker().busy() || model_.background.finds_outlines(); }
  /// Returns whether what is under the cursor is not known yet: a press on a new session picks nothing. Starts to find
  /// out, and poll() has something new when it is known.
  bool searching() { return mouse_.searching(); }
  /// Returns brushed vertices that no handle reaches: they are kept, and join the region when they become connected.
  /// Ascending.
  const std::vector<int>& unconnected() const { return model_.unconnected; }
  /// Returns position and size of the gizmo, if there is an active group and the gizmo is switched on.
  std::optional<Gizmo> gizmo(const Camera& view) const { return model_.gizmo(view); }
  GizmoElement gizmo_element() const { return mouse_.gizmo_element(); }  ///< under the cursor, or held
  /// Returns a preview of what a press would pick, null if nothing.
  const HoverPreview* hover() const { return mouse_.preview(); }
  const std::vector<Vector2>* lasso() const { return mouse_.lasso(); }  ///< being drawn, pixels; null: none
  /// Returns whether hover() was last called for a cursor that was on neither mesh nor gizmo, and nothing is dragged.
  bool is_beside() { return !motion() && !searching() && hover() == nullptr && gizmo_element() == GizmoElement::None; }
  std::string message() const;  ///< one line: the last refusal, otherwise the effect of the next click
  void forget_refusal() { model_.refusal.clear(); }
  /// Returns the problem with the pose of the drag in progress or of the last step, and the remedy; empty if none is
  /// known.
  std::string warning() const;
  DragFigures figures() const { return solver_.figures(); }

  // Settings ---------------------------------------------------------------------------------------------------------

  const DragSettings& settings() const { return model_.settings; }
  /// Returns the settings with the radius that a press at the cursor would take, for a wheel that changes it.
  DragSettings settings_at_cursor() const;
  /// Re-solves the drag in progress or, until something else is picked, the step applied last. Another detail without
  /// such a step is a step of its own, without a handle. Values out of range are
  /// refused by message() and leave the settings as they were.
  /// @param passing  only shows the result: another change follows
  void set_settings(const DragSettings& settings, bool passing = false);
  const Tools& tools() const { return model_.tools; }
  /// A change of the mirror plane, or of what is painted, is refused by message() while a step is solved
  /// for.
  void set_tools(const Tools& tools);
  /// Changes one of them, for example set(&Tools::snaps, true).
  template <class Value, class Given>
  void set(Value Tools::*tool, const Given& value) {
    Tools changed = tools();
    changed.*tool = value;
    set_tools(changed);
  }
  void set_mode(HandleMode mode);       ///< how clicks define a handle
  void take_by_click(HandleMode mode);  ///< makes the next click a handle, not another group or region
  Vector3 pivot_position() const { return model_.pivot_position(); }  ///< requires an active group
  void find_mirror();                                                 ///< mirrors at the plane of find_symmetry()

  /// The step applied last, until something else is picked.
  std::optional<LastStep> last_step() const { return solver_.last_step(); }
  /// Solves the step again with this motion, or with a fraction of it, 0 to 1; for a bent curve only the fraction
  /// applies. message() refuses values out of range.
  /// @param passing  only shows the result: another change follows
  void set_last_step(const HandleTransform& motion, double fraction, bool passing = false);

  // Mouse ------------------------------------------------------------------------------------------------------------
  // A press and a release without a move between them are a click: the caller decides how far a move has to be.

  /// Presses the button. @return false if the cursor was neither on the mesh nor on a mark: the window may rotate its
  /// view
  bool press(const Cursor& cursor, PressModifiers modifiers = {}) { return mouse_.press(cursor, modifiers); }
  void move(const Cursor& cursor) { mouse_.move(cursor); }  ///< also without a press: keys R, S, T follow the mouse
  /// Handles the cursor without a button. The work is bounded, independent of the mesh. @return whether hover() or
  /// gizmo_element() changed
  bool hover(const Cursor& cursor, PressModifiers modifiers) { return mouse_.hover(cursor, modifiers); }
  void leave() { mouse_.leave(); }  ///< the cursor has left the view
  void release(const Cursor& cursor) { mouse_.release(cursor); }
  /// Returns the point of the surface that a press would take; none over a handle or gizmo, beside the mesh, and while
  /// a step is solved.
  std::optional<Vector3> surface_at(const Cursor& cursor, PressModifiers modifiers) {
    return mouse_.surface_at(cursor, modifiers);
  }

  // Keys -------------------------------------------------------------------------------------------------------------

  /// Handles a key; kKeyHelp describes them. @return whether the key has a meaning now
  bool key(DragKey key, const Cursor& cursor = {});
  void cancel();  ///< cancels the drag in progress; no bit of the mesh has changed

  // Region -----------------------------------------------------------------------------------------------------------

  /// Makes vertices, in any order, the region, with the handles inside it, the active handle, or the region's anchors.
  void set_painted(BrushTarget target, std::vector<int> vertices);
  void change_painted(PaintChange change);  ///< of the brush's target; one action of timeline()
  void whole_component();                   ///< the connected components of the handles
  void clear();                             ///< no region, no handle, no fixed vertices
  void keep_painted();                      ///< no handle; only a painted region, and the fixed vertices
  Inheritance inheritance() const;
  /// Continues an earlier session, before anything is done: takes over settings and switches, if the faces are the same
  /// what was painted, and for saved() the steps.
  void inherit(const Inheritance& before);

  // Steps ------------------------------------------------------------------------------------------------------------

  bool can_undo() const;
  bool can_redo() const;
  void undo();  ///< cancels a drag in progress; otherwise undoes the last of timeline().done()
  void redo();
  /// Undoes or redoes until this number of actions of timeline() is done; cancels a drag in progress.
  void go_to(std::size_t actions);
  const Timeline& timeline() const { return model_.timeline; }
  /// Returns the applied steps, with counts and connectivity of the mesh.
  Edit recorded() const { return model_.history.recorded(); }
  /// Returns the same with positions, see with_positions(), or else the steps before inherit().
  Edit saved() const;
  bool has_steps() const { return model_.history.can_undo() || model_.history.can_redo(); }  ///< applied or undone
  bool can_save() const { return model_.history.can_undo() || !earlier_.steps.empty(); }
  /// Applies the steps of an edit to the current mesh as steps of this session, in the background.
  /// @param off_surface  appended to the refusal of a point off the surface
  void load(Edit edit, const std::string& off_surface = {});

  // Worker -----------------------------------------------------------------------------------------------------------

  /// Takes the worker's results. @return whether there is anything new to show
  bool poll();
  /// Ends what is in progress, when the user leaves: waits some time for a released drag, and cancels all other work.
  /// @return false if the drag is still being solved: take_change() returns the mesh without it, a later poll() applies
  /// it
  bool finish(std::chrono::milliseconds longest);
  /// Returns the vertices that have moved since the last call, null if none; valid until the next call of any function.
  /// The window has to write them: a pose in progress, or steps applied or undone. Frames allocate nothing.
  const PoseChange* take_change() { return model_.take_change(); }
  /// Calls poll() until the worker is idle. For tests.
  void wait();

 private:
  /// What a change of settings affects: the last step, a step that changes the detail, region and discs, the discs, or
  /// the preparation alone.
  enum class Effect { Nothing, LastStep, Detail, Radius, Discs, Options };

  Effect effect_of_settings(const DragSettings& before, bool passing) const;
  bool settle_down();
  void set_mirror(const std::optional<MirrorPlane>& plane);
  std::string next_click() const;
  template <class Choose>
  bool change_region(const Choose& choose);
  bool motion_key(DragKey key, const Cursor& cursor);
  bool begin_by_key(MotionKind kind, const Cursor& cursor);

  Edit earlier_;  // the steps before inherit()
  SessionModel model_;
  SessionSolver solver_;
  SessionMouse mouse_;
};

}  // namespace lapedit
