// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "lapedit/edit/solver_thread.h"
#include "lapedit/mesh/visibility.h"
#include "lapedit/session/drag_session.h"
#include "lapedit/session/history.h"
#include "lapedit/session/selection.h"
#include "lapedit/session/shown_region.h"

// The inside of DragSession.
namespace lapedit {

/// What a session is doing, and what means something only meanwhile.
namespace phase {

/// A mouse event that came while a step was worked out: it is taken up on the mesh that the step leaves.
struct MouseEvent {
  enum class Kind { Press, Move, Release } kind;
  Cursor cursor;
  PressModifiers modifiers;
};
using MouseEvents = std::vector<MouseEvent>;

/// A motion of the active group, and the solves that it asked for.
struct Drag {
  DragMotion motion;
  bool by_button;                      ///< held, rather than begun by a key
  std::vector<HandleTransform> given;  ///< of the user's groups
  std::vector<Affine> maps;            ///< of all groups; both kept for their memory
  int first_serial = std::numeric_limits<int>::max(), last_serial = 0;
};

/// There is no handle.
struct Idle {};

/// There is a handle.
struct Picked {
  bool amendable = false;  ///< the step applied last is still what settings are about
};

/// The handle follows the mouse or typed numbers.
struct Dragging {
  Drag drag;
};

/// The exact result of a drag is being solved for.
struct Releasing {
  Drag drag;
  MouseEvents waiting;
};

/// The last step is being solved for again, with other settings.
struct Amending {
  EditStep step;
  std::shared_ptr<const TriangleMesh> base;  ///< the mesh before the step
  int serial = 0;                            ///< of the solve
  MouseEvents waiting;
};

/// The steps of a saved edit are being applied.
struct Loading {
  Edit edit;
  bool amendable;  ///< as it was, should this be dropped
  MouseEvents waiting;
};

using Phase = std::variant<Idle, Picked, Dragging, Releasing, Amending, Loading>;

}  // namespace phase

/// What the user has switched on, beside settings and selection.
struct Tools {
  BrushTarget brush = BrushTarget::Region;
  bool gizmo = false;
  GizmoAxes axes = GizmoAxes::Layer;
  Pivot pivot = Pivot::Centroid;
  int pivot_vertex = -1;  ///< Pivot::Point; -1: the next click picks it
  std::optional<MirrorPlane> mirror;
  std::unique_ptr<const MirroredHandles> mirrored;  ///< of the groups; null without a plane and while they are painted
};

/// The cursor while no button is down.
struct Pointer {
  explicit Pointer(std::function<void()> wake) : background(std::move(wake)) {}

  HoverBackground background;
  std::optional<HoverPreview> preview;
  GizmoPart part = GizmoPart::None;  ///< also of the motion that it was dragged by
};

/// Strokes of the brush since the last step, for undo.
struct Strokes {
  std::vector<Selection> done;    ///< before each of them, the oldest first
  std::vector<Selection> undone;  ///< after each that was taken back, the newest last
};

/// A mouse button that is down.
struct Press {
  Vector3 point;    // what was grabbed
  int vertex = -1;  // nearest to it
  Cursor cursor;
  PressModifiers modifiers;
  bool draggable = true;
  bool brushed = false, recorded = false;
  bool on_gizmo = false;
  std::optional<Vector3> axis = std::nullopt;  // of a gizmo's arrow or ring
  MotionKind kind = MotionKind::Translate;

  bool plain() const { return !modifiers.add && !modifiers.take; }
};

/// The states of a session and how one leads to another. DragSession tells it what mouse, keys and buttons want.
///
/// What the session is doing is its phase; the other fields last from one phase to the next.
struct SessionCore {
  enum class Preparation { None, Running, Done };

  DragSession::Callbacks callbacks;
  StoredScalar scalar;
  History history;
  std::shared_ptr<const Adjacency> adjacency;
  DragSettings settings;
  Selection selection;
  Tools tools;
  Strokes strokes;
  phase::Phase phase;
  std::optional<Press> pressed;  // the mouse button that is down
  std::string refusal;
  ShownRegion shown;
  std::unique_ptr<Visibility> visibility;  // of the mesh as it is, once the brush has asked
  std::vector<int> unconnected;            // of the selection's vertices, ascending
  Pointer pointer;
  Preparation preparation = Preparation::None;
  bool in_hand = false;  // drags are followed, if only by the stand-in
  DragFigures heard;     // times and errors, from the worker
  SolverPose solved;
  SolverThread worker;  // last: its thread ends first

  /// @throws EditError as validate()
  SessionCore(TriangleMesh mesh, StoredScalar stored, DragSession::Callbacks given);

  const TriangleMesh& original() const { return history.original(); }
  const TriangleMesh& mesh() const { return *history.mesh(); }
  const std::vector<std::vector<int>>& groups() const { return selection.groups; }
  /// With their mirror images behind them.
  const std::vector<std::vector<int>>& all_groups() const {
    return tools.mirrored ? tools.mirrored->groups() : groups();
  }
  Surface surface() const {
    return {mesh(), *adjacency, settings, shown.region().get(), preparation == Preparation::Done};
  }
  Vector3 center() const { return centroid(mesh().vertices, groups()[selection.active]); }
  Vector3 pivot_place() const;
  std::optional<Gizmo> gizmo(const Camera& view) const;

  // Phases.
  template <class P>
  P* in() {
    return std::get_if<P>(&phase);
  }
  phase::Drag* drag();
  phase::MouseEvents* waiting();
  bool amendable();
  bool in_progress() { return drag() != nullptr || waiting() != nullptr; }
  void rest(bool amendable);
  void drop();
  bool settle_down();
  void end_stroke();

  // What is seen.
  void log(const std::string& line) {
    if (callbacks.log) {
      callbacks.log(line);
    }
  }
  void show(const std::vector<int>& vertices, const Points& places, bool settled) {
    if (callbacks.pose) {
      callbacks.pose(vertices, places, settled);
    }
  }
  void show_mesh(const std::vector<int>& vertices, const Points& places, bool settled);
  void show_region(std::shared_ptr<const Region> region) { shown.show(std::move(region), mesh()); }
  void show_by_hand();
  void back_to_mesh(bool settled);

  // Region and handles.
  bool take(Choice choice);
  void handles_changed();
  void find_unconnected(const Region& region);
  bool undo_stroke();
  bool redo_stroke();
  void restore(Selection before);
  void prepare();

  // Motion.
  bool begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button);
  void ask();
  void release_motion();

  // Steps.
  void amend();
  phase::MouseEvents commit_release();
  phase::MouseEvents commit_amended();
  phase::MouseEvents commit_loaded(const std::vector<EditResult>& results);
  void go_on();
  void take_over(const AppliedStep& step, bool applied);

  // News of the worker.
  bool listen(phase::MouseEvents& waited);
  phase::MouseEvents take_pose();
  void on_error(const std::string& sentence);
};

}  // namespace lapedit
