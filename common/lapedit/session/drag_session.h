// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lapedit/session/drag_key.h"
#include "lapedit/session/session_model.h"
#include "lapedit/session/session_mouse.h"
#include "lapedit/session/session_solver.h"

// From a click to a saved edit, as a window does it (wait() in place of its event loop):
//
//   DragSession session(mesh, StoredScalar::Float, callbacks);
//   session.press({camera, pixel});                        // takes a handle, and a region around it
//   session.move({camera, pixel + Vector2(40, 0)});        // poll() and take_change(): what the surface looks like
//   session.release({camera, pixel + Vector2(40, 0)});
//   session.wait();                                        // session.mesh() is the edited mesh
//   const Edit edit = session.recorded();                  // for apply_edit(), or to be written as JSON

namespace lapedit {

/// One dragging session with one mesh: what the interactive tool does, without a window.
///
/// Mouse and keys in, poses out. Nothing here waits: regions are prepared and poses solved by a worker thread, and
/// poll() takes them up; take_change() says which vertices have moved since. Each release applies one EditStep to the
/// mesh. recorded() holds them all: applied to original() by apply_edit() they give mesh() bit for bit. User input
/// never makes a function throw: message() says what was refused.
class DragSession {
 public:
  enum class State {
    Idle,      ///< no handle
    Picked,    ///< a handle; its region is shown as soon as it is known
    Dragging,  ///< the handle follows the mouse or typed numbers
    Settling   ///< released: the exact result is on its way
  };

  struct Callbacks {
    /// One line for a log: a step was applied, undone, refused.
    std::function<void(const std::string&)> log;
    /// Called from the worker's thread: call poll() soon, from your own.
    std::function<void()> wake;
  };

  /// @param mesh    the mesh at the beginning
  /// @param scalar  precision of the mesh that takes the poses
  /// @throws EditError (EmptyMesh, BadIndex) as validate()
  DragSession(TriangleMesh mesh, StoredScalar scalar, const Callbacks& callbacks);
  DragSession(const DragSession&) = delete;
  DragSession& operator=(const DragSession&) = delete;

  // What there is to see ---------------------------------------------------------------------------------------------

  State state() const;
  const TriangleMesh& original() const { return model_.history.original(); }
  const TriangleMesh& mesh() const { return model_.mesh(); }  ///< with all applied steps, without a drag in progress
  const Adjacency& adjacency() const { return *model_.adjacency; }
  const Region* region() const {
    return model_.shown.region().get();
  }  ///< classified region to show, null if there is none or it is not known yet
  int region_serial() const { return model_.shown.region_serial(); }  ///< counts the changes of region()
  const Points& pose() const {
    return model_.shown.pose();
  }  ///< where region()'s vertices are now, one row per vertex; changes with pose_serial()
  int pose_serial() const { return model_.shown.serial(); }  ///< counts the changes of region() and pose()
  const std::vector<std::vector<int>>& groups() const {
    return model_.groups();
  }  ///< handle groups, mesh vertex numbers
  /// These, each with what of its mirror image it touches, and behind them the other images.
  const std::vector<std::vector<int>>& mirrored_groups() const { return model_.all_groups(); }
  int group_of_image(int group) const;  ///< mirrored_groups() -> groups(): the same number but for images
  int active_group() const { return model_.selection.active; }  ///< the one that moves, -1 if there is none
  Affine active_map() const;         ///< where the drag wants the active group, also before any pose is solved
  const DragMotion* motion() const;  ///< the drag in progress, null if there is none
  bool preparing() const { return solver_.preparing(); }           ///< a region is on its way
  double progress() const { return solver_.worker().progress(); }  ///< of that, 0 to 1
  const char* stage() const { return solver_.worker().stage(); }   ///< of that
  bool in_hand() const { return solver_.in_hand(); }     ///< a drag is followed at once, if only by the region's cells
  bool ready() const { return solver_.ready(); }         ///< the region is prepared
  bool busy() const { return solver_.worker().busy(); }  ///< poll() has, or will have, something new
  /// Brushed vertices that no handle reaches: kept, and part of the region once something connects them. Ascending.
  const std::vector<int>& unconnected() const { return model_.unconnected; }
  /// Of the picture: where it is and how large, if there is an active group and it is switched on.
  std::optional<Gizmo> gizmo(const Camera& view) const { return model_.gizmo(view); }
  GizmoPart gizmo_part() const { return mouse_.gizmo_part(); }    ///< under the cursor, or held
  const HoverPreview* hover() const { return mouse_.preview(); }  ///< what a press would take, null if nothing
  std::string message() const;  ///< one line: what was refused, else what the next click does
  void forget_refusal() { model_.refusal.clear(); }
  /// What is wrong with the pose of the drag in progress or of the last step, and what to do; empty: nothing is known.
  std::string warning() const;
  bool next_is_region() const { return model_.selection.next == Selection::Next::Region; }  ///< of a click
  const std::vector<int>& held() const { return model_.selection.held; }  ///< painted to stay, ascending
  DragFigures figures() const { return solver_.figures(); }

  // Settings ---------------------------------------------------------------------------------------------------------

  const DragSettings& settings() const { return model_.settings; }
  /// Re-solves the drag in progress or, until something else is picked, the step applied last. Values out of range are
  /// refused by message() and leave the settings as they were.
  void set_settings(const DragSettings& settings);
  HandleMode handle_mode() const { return model_.selection.mode; }
  void set_handle_mode(HandleMode mode);
  BrushTarget brush_target() const { return model_.tools.brush; }
  void set_brush_target(BrushTarget target);
  /// While it is on, the brush paints what is kept fixed, and needs no modifier.
  bool keeps_fixed() const { return model_.tools.keeps_fixed; }
  void set_keep_fixed(bool on);
  bool gizmo_shown() const { return model_.tools.gizmo; }
  GizmoAxes gizmo_axes() const { return model_.tools.axes; }
  void show_gizmo(bool on, GizmoAxes axes);
  Pivot pivot() const { return model_.tools.pivot; }
  void set_pivot(Pivot pivot);                                  ///< Point: the next click picks it
  Vector3 pivot_place() const { return model_.pivot_place(); }  ///< there has to be an active group
  /// Every step goes on both sides of the plane at once; nothing: off.
  const std::optional<MirrorPlane>& mirror() const { return model_.tools.mirror; }
  void set_mirror(const std::optional<MirrorPlane>& plane);
  void find_mirror();  ///< the plane that the mesh is most nearly symmetric about, see find_symmetry()

  // Mouse ------------------------------------------------------------------------------------------------------------
  // A press and a release without a move between them are a click: the host decides how far a move has to be.

  /// @return false if it was beside the mesh and every mark on it: the host may turn its view
  bool press(const Cursor& cursor, PressModifiers modifiers = {}) { return mouse_.press(cursor, modifiers); }
  void move(const Cursor& cursor) { mouse_.move(cursor); }  ///< also without a press: keys R, S, T follow the mouse
  /// The cursor rests or goes here with no button down. Bounded work, whatever the mesh. @return whether hover() or
  /// gizmo_part() changed
  bool hover(const Cursor& cursor, PressModifiers modifiers) { return mouse_.hover(cursor, modifiers); }
  void leave() { mouse_.leave(); }  ///< the cursor is elsewhere
  void release(const Cursor& cursor) { mouse_.release(cursor); }

  // Keys -------------------------------------------------------------------------------------------------------------

  /// Handles a key; kKeyHelp describes them. @return whether the key has a meaning now
  bool key(DragKey key, const Cursor& cursor);
  void apply();   ///< applies the drag in progress
  void cancel();  ///< drops the drag in progress, not one bit of the mesh has changed

  // Region -----------------------------------------------------------------------------------------------------------

  void set_region(std::vector<int> vertices);   ///< any order; with the handles inside it, if there are
  void set_anchors(std::vector<int> vertices);  ///< these of the region hold, in place of its band
  void whole_component();                       ///< the connected components of the handles
  void grow();                                  ///< by a ring
  void shrink();
  void new_region();  ///< the next click takes a new region
  void next_group();  ///< the next click makes another handle group
  void clear();       ///< no region, no handle

  // Steps ------------------------------------------------------------------------------------------------------------

  bool can_undo() const;
  bool can_redo() const;
  void undo();  ///< of a drag in progress: drops it; else the last of timeline().done()
  void redo();
  void reset();  ///< undoes all steps, and what came after the first
  const Timeline& timeline() const { return model_.timeline; }
  Edit recorded() const {
    return model_.history.recorded();
  }  ///< applied steps, with counts and connectivity of the mesh
  /// Applies the steps of an edit to the mesh as it is, as steps of this session. Works in the background.
  void load(Edit edit);

  // Worker -----------------------------------------------------------------------------------------------------------

  /// Takes what the worker has done. @return whether there is anything new to show
  bool poll();
  /// Applies what was released, for which it waits, and drops all else that is in progress: afterwards the state is not
  /// Dragging or Settling.
  void finish();
  /// Which vertices have moved since the last call, null if none; until the next call of any function. What the host
  /// has to write: a pose in progress, steps applied or taken back. Nothing is allocated from frame to frame.
  const PoseChange* take_change() { return model_.take_change(); }
  /// poll() until the worker has nothing to do. For tests.
  void wait();

 private:
  bool settle_down();
  std::string next_click() const;
  template <class Choose>
  void change_region(const Choose& choose);
  void turn_round(Action& action, bool again);
  bool motion_key(DragKey key, const Cursor& cursor);
  bool begin_by_key(MotionKind kind, const Cursor& cursor);

  SessionModel model_;
  SessionSolver solver_;
  SessionMouse mouse_;
};

}  // namespace lapedit
