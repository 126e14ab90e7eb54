// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/edit/edit.h"
#include "lapedit/edit/mirror.h"
#include "lapedit/session/drag_key.h"
#include "lapedit/session/drag_motion.h"
#include "lapedit/session/drag_settings.h"
#include "lapedit/session/gizmo.h"
#include "lapedit/session/hover.h"

// From a click to a saved edit, as a window does it (wait() in place of its event loop):
//
//   DragSession session(mesh, StoredScalar::Float, callbacks);
//   session.press({camera, pixel});                        // takes a handle, and a region around it
//   session.move({camera, pixel + Vector2(40, 0)});        // callbacks.pose brings what the surface looks like
//   session.release({camera, pixel + Vector2(40, 0)});
//   session.wait();                                        // session.mesh() is the edited mesh
//   const Edit edit = session.recorded();                  // for apply_edit(), or to be written as JSON

namespace lapedit {

struct PressModifiers {
  bool add = false;   ///< Ctrl: a click adds to the handle, a drag brushes more of what is painted
  bool take = false;  ///< Shift: a click takes from the handle, a drag brushes less of it
};

/// What the brush paints.
enum class BrushTarget { Region, Handle, Anchors };

/// What turning and scaling go about.
enum class Pivot {
  Centroid,  ///< of the active group
  Rim,       ///< the middle of the region's rim on the group's piece: the shoulder of an arm
  Point      ///< a vertex that was picked; it goes with the surface
};

/// What the panel shows. Counts of the region; milliseconds; lengths in model units.
struct DragFigures {
  int handle = 0, free = 0, anchors = 0, fixed = 0;
  // What is not known, as the region is being prepared or nothing was posed in it yet, is nothing.
  std::optional<double> in_hand_ms;  ///< until a drag could be followed
  std::optional<double> prepare_ms;
  std::optional<double> solve_ms;         ///< of the last pose
  std::optional<double> handle_error;     ///< largest distance of a handle vertex from its target, of the last report
  std::optional<double> largest_stretch;  ///< of an edge, new over old length minus 1, of the last report
  std::string advice;                     ///< of the last report, where something folded
  std::string taken_over;                 ///< what preparing took over from the region before
  int steps = 0;                          ///< applied
};

/// One dragging session with one mesh: what the interactive tool does, without a window.
///
/// Mouse and keys in, poses out. Nothing here waits: regions are prepared and poses solved by a worker thread, and
/// poll() hands their results on. Each release applies one EditStep to the mesh, of which recorded() tells all: applied
/// to original() by apply_edit() they give mesh() bit for bit. No function throws for what a user can do; what is not
/// possible is told by message().
class DragSession {
 public:
  enum class State {
    Idle,      ///< no handle
    Picked,    ///< a handle; its region is shown as soon as it is known
    Dragging,  ///< the handle follows the mouse or typed numbers
    Settling   ///< released: the exact result is on its way
  };

  struct Callbacks {
    /// New places of some vertices (ascending mesh vertex numbers). settled: they are the mesh now, else a passing pose
    std::function<void(const std::vector<int>&, const Points&, bool settled)> pose;
    /// One line for a log: a step was applied, undone, refused.
    std::function<void(const std::string&)> log;
    /// Called from the worker's thread: call poll() soon, from your own.
    std::function<void()> wake;
  };

  /// @param mesh    the mesh at the beginning
  /// @param scalar  precision of the mesh that takes the poses
  /// @throws EditError (EmptyMesh, BadIndex) as validate()
  DragSession(TriangleMesh mesh, StoredScalar scalar, Callbacks callbacks);
  ~DragSession();

  // What there is to see ---------------------------------------------------------------------------------------------

  State state() const;
  const TriangleMesh& original() const;
  const TriangleMesh& mesh() const;  ///< with all applied steps, without a drag in progress
  const Adjacency& adjacency() const;
  const Region* region() const;  ///< classified region to show, null if there is none or it is not known yet
  int region_serial() const;     ///< counts the changes of region()
  const Points& pose() const;    ///< where region()'s vertices are now, one row per vertex; changes with pose_serial()
  int pose_serial() const;       ///< counts the changes of region() and pose()
  const std::vector<std::vector<int>>& groups() const;  ///< handle groups, mesh vertex numbers
  /// These, each with what of its mirror image it touches, and behind them the other images.
  const std::vector<std::vector<int>>& mirrored_groups() const;
  int group_of_image(int group) const;  ///< mirrored_groups() -> groups(): the same number but for images
  int active_group() const;             ///< the one that moves, -1 if there is none
  Affine active_map() const;            ///< where the drag wants the active group, also before any pose is solved
  const DragMotion* motion() const;     ///< the drag in progress, null if there is none
  bool preparing() const;               ///< a region is on its way
  double progress() const;              ///< of that, 0 to 1
  const char* stage() const;            ///< of that
  bool in_hand() const;                 ///< a drag is followed at once, if only by the region's stand-in
  bool ready() const;                   ///< the region is prepared
  bool busy() const;                    ///< poll() has, or will have, something new
  /// Brushed vertices that no handle reaches: kept, and part of the region once something connects them. Ascending.
  const std::vector<int>& unconnected() const;
  /// Of the picture: where it is and how large, if there is an active group and it is switched on.
  std::optional<Gizmo> gizmo(const Camera& view) const;
  GizmoPart gizmo_part() const;       ///< under the cursor, or held
  const HoverPreview* hover() const;  ///< what a press would take, null if nothing
  std::string message() const;        ///< one line: what was refused, else what the next click does
  DragFigures figures() const;

  // Settings ---------------------------------------------------------------------------------------------------------

  const DragSettings& settings() const;
  /// Re-solves the drag in progress or, until something else is picked, the step applied last. Values out of range are
  /// refused by message() and leave the settings as they were.
  void set_settings(const DragSettings& settings);
  HandleMode handle_mode() const;
  void set_handle_mode(HandleMode mode);
  BrushTarget brush_target() const;
  void set_brush_target(BrushTarget target);
  bool gizmo_shown() const;
  GizmoAxes gizmo_axes() const;
  void show_gizmo(bool on, GizmoAxes axes);
  Pivot pivot() const;
  void set_pivot(Pivot pivot);  ///< Point: the next click picks it
  Vector3 pivot_place() const;  ///< there has to be an active group
  /// Every step goes on both sides of the plane at once; nothing: off.
  const std::optional<MirrorPlane>& mirror() const;
  void set_mirror(const std::optional<MirrorPlane>& plane);
  void find_mirror();  ///< the plane that the mesh is most nearly symmetric about, see find_symmetry()

  // Mouse ------------------------------------------------------------------------------------------------------------
  // A press and a release without a move between them are a click: the host decides how far a move has to be.

  /// @return false if it was beside the mesh and every mark on it: the host may turn its view
  bool press(const Cursor& cursor, PressModifiers modifiers = {});
  void move(const Cursor& cursor);  ///< also without a press: keys R, S, T follow the mouse
  /// The cursor rests or goes here with no button down. Bounded work, whatever the mesh. @return whether hover() or
  /// gizmo_part() changed
  bool hover(const Cursor& cursor, PressModifiers modifiers);
  void leave();  ///< the cursor is elsewhere
  void release(const Cursor& cursor);

  // Keys -------------------------------------------------------------------------------------------------------------

  /// What each does is told by kKeyHelp. @return whether the key means anything now
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
  void undo();  ///< of a drag in progress: drops it; of strokes of the brush since the last step: the last one
  void redo();
  void reset();           ///< undoes all
  Edit recorded() const;  ///< applied steps, with counts and connectivity of the mesh
  /// Applies the steps of an edit to the mesh as it is, as steps of this session. Works in the background.
  void load(Edit edit);

  // Worker -----------------------------------------------------------------------------------------------------------

  /// Takes what the worker has done. @return whether there is anything new to show
  bool poll();
  /// Applies what was released, for which it waits, and drops all else that is in progress: afterwards the state is not
  /// Dragging or Settling.
  void finish();
  /// poll() until the worker has nothing to do. For tests.
  void wait();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
