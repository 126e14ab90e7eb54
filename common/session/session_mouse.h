// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/session/session_solver.h"

namespace lapedit {

struct PressModifiers {
  bool add = false;    ///< Ctrl: a click adds to the handle, a stroke to the brush's target
  bool take = false;   ///< Shift: a click removes from the handle, a stroke from the brush's target
  bool lasso = false;  ///< Alt, with one of them: a closed line paints what is visible inside

  bool none() const { return !add && !take; }
};

/// Interprets the mouse: decides which handle or region a press picks, where drags and strokes of the brush begin and
/// end, and previews a press.
class SessionMouse {
 public:
  SessionMouse(SessionModel& model, SessionSolver& solver) : model_(model), solver_(solver) {}

  // As DragSession's functions.
  bool press(const Cursor& cursor, PressModifiers modifiers);
  void move(const Cursor& cursor);
  void release(const Cursor& cursor);
  bool hover(const Cursor& cursor, PressModifiers modifiers);
  void leave();
  std::optional<Vector3> surface_at(const Cursor& cursor, PressModifiers modifiers);
  const HoverPreview* preview() const { return preview_ ? &*preview_ : nullptr; }
  GizmoElement gizmo_element() const { return element_; }

  /// Returns the pixels of the lasso that is being drawn; none: null.
  const std::vector<Vector2>* lasso() const {
    return pressed_ && !pressed_->lasso.empty() ? &pressed_->lasso : nullptr;
  }
  bool brushing() const { return pressed_ && !pressed_->modifiers.none(); }
  /// Ends a stroke of the brush that another action interrupts.
  void end_stroke();
  /// Ends the motion at its current position.
  void release_motion();
  /// Handles the events that arrived while a step was solved, on the mesh after the step.
  void replay();
  void poll();  ///< also replays them, once the search over that mesh is ready, and takes outlines
  bool searching();
  /// Waits for search and outlines. @return whether they were not ready. For tests.
  bool wait();
  /// Discards pressed buttons, and events that arrived while a step was solved.
  void forget();
  bool has_waiting() const { return !waiting_.empty(); }
  void drop_waiting() { waiting_.clear(); }

 private:
  struct Event {
    enum class Kind { Press, Move, Release } kind;
    Cursor cursor;
    PressModifiers modifiers;
  };

  /// A button that is down.
  struct Press {
    Vector3 point;    // of the surface, which was grabbed
    int vertex = -1;  // nearest to it
    Cursor cursor;
    PressModifiers modifiers;
    bool draggable = true;
    bool brushed = false, recorded = false;
    bool on_gizmo = false, on_handle = false;
    bool moves = false;                          // with Shift, where a plain drag would rotate
    int group = -1;                              // the group that was grabbed
    int curve_point = -1;                        // of that group
    std::optional<Vector3> axis = std::nullopt;  // of a gizmo's arrow or ring
    MotionKind kind = MotionKind::Translate;
    std::vector<Vector2> lasso = {};  // pixels
  };

  std::optional<SurfaceHit> hit(const Cursor& cursor);
  Cursor snapped(const Cursor& cursor, MotionKind kind) const;
  GizmoElement element_at(const std::optional<Gizmo>& gizmo, const Cursor& cursor);
  bool press_gizmo(const Cursor& cursor);
  bool press_beneath(const Cursor& cursor, PressModifiers modifiers);
  void press_surface(const SurfaceHit& hit, const Cursor& cursor, PressModifiers modifiers);
  void click(const Press& press);
  void brush(const Cursor& cursor);
  void close_lasso(const Cursor& cursor);
  void paint(const std::vector<int>& patch);
  HoverQuery query(const SurfaceHit& hit, const Camera& view, bool with_region) const;
  void look(const Cursor& cursor, PressModifiers modifiers);
  void take_outlines();
  int group_at(const std::optional<SurfaceHit>& hit, const Cursor& cursor) const;
  bool grabs(PressModifiers modifiers) const;
  bool turns() const;
  void preview_curve(HoverSearch& search, const SurfaceHit& hit, const Cursor& cursor, HoverPreview& preview);

  SessionModel& model_;
  SessionSolver& solver_;
  std::optional<Press> pressed_;
  std::vector<Event> waiting_;  // arrived while a step was solved, or before the search over its mesh was ready
  // Valid while no button is down.
  std::optional<HoverPreview> preview_;
  std::optional<HoverQuery> wanted_;           // query of the preview's outlines; none: no outlines
  GizmoElement element_ = GizmoElement::None;  // under the cursor, or dragged
};

}  // namespace lapedit
