// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/session/messages.h"
#include "lapedit/session/session_impl.h"

namespace lapedit {

using namespace phase;

// --- Mouse ----------------------------------------------------------------------------------------------------------

bool DragSession::press(const Cursor& cursor, PressModifiers modifiers) {
  Impl& s = *impl_;
  if (!cursor.view.valid()) {
    return true;
  }
  if (MouseEvents* const waiting = s.waiting()) {
    waiting->push_back({MouseEvent::Kind::Press, cursor, modifiers});
    return true;
  }
  s.refusal.clear();
  if (const Drag* const drag = s.drag()) {
    if (!drag->by_button) {
      apply();
    }
    return true;
  }
  s.end_stroke();  // whose release never came
  if (!modifiers.add && !modifiers.take && s.press_gizmo(cursor)) {
    return true;
  }
  return s.press_beneath(cursor, modifiers);
}

/// A press on what is behind the gizmo.
bool DragSession::Impl::press_beneath(const Cursor& cursor, PressModifiers modifiers) {
  const std::optional<SurfaceHit> hit = surface_at(mesh(), *adjacency, cursor);
  if (tools.pivot == Pivot::Point && tools.pivot_vertex < 0 && !modifiers.add && !modifiers.take) {
    if (hit) {
      tools.pivot_vertex = hit->vertex;
    } else {
      refusal = messages::kNoSurface;
    }
    return hit.has_value();
  }
  const bool grabs = !modifiers.add && !modifiers.take && selection.next != Selection::Next::Region;
  const int grabbed = grabs ? group_at(mesh(), groups(), hit, cursor, settings.radius) : -1;
  if (grabbed >= 0) {
    selection.active = grabbed;
    pressed = Press{hit ? hit->point : cursor.view.beside(center(), cursor.pixel), -1, cursor, modifiers};
  } else if (hit) {
    press_surface(*hit, cursor, modifiers);
  } else {
    refusal = messages::kNoSurface;
    return false;
  }
  return true;
}

void DragSession::move(const Cursor& cursor) {
  Impl& s = *impl_;
  if (!cursor.view.valid()) {
    return;
  }
  if (MouseEvents* const waiting = s.waiting()) {
    // Only what follows a press counts, and of moves the last.
    if (!waiting->empty()) {
      if (waiting->back().kind == MouseEvent::Kind::Move) {
        waiting->pop_back();
      }
      waiting->push_back({MouseEvent::Kind::Move, cursor, {}});
    }
    return;
  }
  if (s.pressed && !s.pressed->plain()) {
    if (!std::exchange(s.pressed->brushed, true)) {
      s.brush(s.pressed->cursor);
    }
    s.brush(cursor);
    return;
  }
  if (s.pressed && !s.drag()) {
    // The motion begins where the button went down, however far the first move already is.
    if (!s.pressed->draggable || !s.begin(s.pressed->kind, s.pressed->point, s.pressed->cursor, true)) {
      if (s.pressed) {
        s.pressed->draggable = false;  // why not has been said
      }
      return;
    }
    if (s.pressed->axis) {
      s.drag()->motion.hold(*s.pressed->axis);
    }
  }
  Drag* const drag = s.drag();
  if (drag && (s.pressed || !drag->by_button)) {
    drag->motion.move(cursor);
    s.ask();
  }
}

bool DragSession::hover(const Cursor& cursor, PressModifiers modifiers) {
  Impl& s = *impl_;
  const bool was = s.pointer.preview.has_value();
  const GizmoPart before = s.pointer.part;
  if (!cursor.view.valid() || s.in_progress() || s.pressed) {
    s.pointer.preview.reset();
    return was;
  }
  const std::optional<Gizmo> gizmo = s.gizmo(cursor.view);
  s.pointer.part = gizmo ? gizmo_part_at(*gizmo, cursor) : GizmoPart::None;
  if (s.pointer.part != GizmoPart::None) {
    s.pointer.preview.reset();
    return was || before != s.pointer.part;
  }
  s.look(cursor, modifiers);
  return was || s.pointer.preview || before != s.pointer.part;
}

void DragSession::leave() {
  impl_->pointer.preview.reset();
  impl_->pointer.part = GizmoPart::None;
}

void DragSession::release(const Cursor& cursor) {
  Impl& s = *impl_;
  MouseEvents* const waiting = s.waiting();
  if (waiting && !waiting->empty()) {
    waiting->push_back({MouseEvent::Kind::Release, cursor, {}});
    return;
  }
  if (waiting || !s.pressed) {
    s.pressed.reset();
    return;
  }
  if (Drag* const drag = s.drag()) {
    if (cursor.view.valid()) {
      drag->motion.move(cursor);
    }
    s.release_motion();
    return;
  }
  const Press press = *s.pressed;
  s.end_stroke();
  if (press.on_gizmo) {  // a click means what is behind it
    s.press_beneath(press.cursor, {});
    s.pressed.reset();
  } else if (!press.plain() && !press.brushed) {
    s.click(press);
  }
}

/// A press on an arrow, a ring or the knob. @return whether it was one
bool DragSession::Impl::press_gizmo(const Cursor& cursor) {
  const std::optional<Gizmo> gizmo = this->gizmo(cursor.view);
  pointer.part = gizmo ? gizmo_part_at(*gizmo, cursor) : GizmoPart::None;
  if (pointer.part == GizmoPart::None) {
    return false;
  }
  pressed = Press{gizmo->center, -1, cursor, {}};
  pressed->on_gizmo = true;
  pressed->kind = kind_of(pointer.part);
  pressed->axis = axis_of(*gizmo, pointer.part);
  return true;
}

namespace {

/// What of the surface is under the cursor or, since a press takes an edge that is right beside it, within 4 pixels.
std::optional<SurfaceHit> hit_near(const HoverSearch& search, const Cursor& cursor) {
  std::optional<SurfaceHit> hit = search.hit(cursor.view.ray(cursor.pixel));
  for (const double pixels : {2.0, 4.0}) {
    for (int i = 0; i < 8 && !hit; ++i) {
      const double angle = i * std::atan(1.0);
      hit = search.hit(cursor.view.ray(cursor.pixel + pixels * Vector2(std::cos(angle), std::sin(angle))));
    }
  }
  return hit;
}

}  // namespace

/// What of the surface is under the cursor, and what a press would take there.
void DragSession::Impl::look(const Cursor& cursor, PressModifiers modifiers) {
  HoverSearch* const search = pointer.background.of(history.mesh(), adjacency);
  const std::optional<SurfaceHit> hit = search ? hit_near(*search, cursor) : std::nullopt;
  if (!hit) {
    pointer.preview.reset();
    return;
  }
  using Kind = HoverPreview::Kind;
  HoverPreview& preview = pointer.preview ? *pointer.preview : pointer.preview.emplace();
  const bool inside =
      selection.has_region && selection.next != Selection::Next::Region && shown.region() &&
      std::binary_search(shown.region()->mesh_vertex.begin(), shown.region()->mesh_vertex.end(), hit->vertex);
  const bool plain = !modifiers.add && !modifiers.take;
  preview.group = plain && selection.next != Selection::Next::Region
                      ? group_at(mesh(), groups(), hit, cursor, settings.radius)
                      : -1;
  preview.kind = !plain ? Kind::Brush : preview.group >= 0 ? Kind::Group : inside ? Kind::Handle : Kind::Region;
  preview.point = hit->point;
  const Vector3 normal = area_normal(mesh(), hit->face);
  const double length = normal.norm();
  preview.normal = length > 0 && std::isfinite(length) ? Vector3(normal / length) : Vector3(Vector3::Zero());
  preview.radius = settings.radius;
  preview.disc_radius = selection.mode == HandleMode::Vertex ? settings.handle_share * settings.radius : 0;
  if (preview.kind == Kind::Region || preview.kind == Kind::Handle) {
    search->outline(hit->vertex, preview);
  } else {
    preview.region.resize(0, 3);
    preview.disc.resize(0, 3);
  }
}

/// A press beside all handles.
void DragSession::Impl::press_surface(const SurfaceHit& hit, const Cursor& cursor, PressModifiers modifiers) {
  pressed = Press{hit.point, hit.vertex, cursor, modifiers};
  if (!pressed->plain()) {
    return;  // a brush or, with the release, a click
  }
  try {
    const bool taken = take(pick(surface(), selection, hit.vertex));
    pressed->draggable = taken && selection.mode == HandleMode::Vertex;
    if (taken) {
      handles_changed();
    }
  } catch (const EditError& error) {
    pressed.reset();
    refusal = error.what();
  }
}

/// A click with Ctrl or Shift.
void DragSession::Impl::click(const Press& press) {
  try {
    const auto choose = press.modifiers.add ? add_to_handle : take_from_handle;
    if (!take(choose(surface(), selection, press.vertex))) {
      return;
    }
  } catch (const EditError& error) {
    refusal = error.what();
    return;
  }
  if (groups().empty() && shown.region()) {
    show_by_hand();
  }
  handles_changed();
}

void DragSession::Impl::brush(const Cursor& cursor) {
  const std::optional<SurfaceHit> hit = surface_at(mesh(), *adjacency, cursor);
  if (!hit) {
    return;
  }
  if (!visibility) {
    visibility = std::make_unique<Visibility>(mesh());
  }
  const double radius = settings.brush_pixels * cursor.view.pixel_size(hit->point);
  const std::vector<int> patch = brushed_vertices(mesh(), *adjacency, *visibility, cursor.view, *hit, radius);
  if (patch.empty()) {
    return;
  }
  const bool add = pressed->modifiers.add;
  Choice choice = tools.brush == BrushTarget::Region   ? Choice(brushed(surface(), selection, patch, add))
                  : tools.brush == BrushTarget::Handle ? handle_brushed(surface(), selection, patch, add)
                                                       : anchors_brushed(surface(), selection, patch, add);
  refusal.clear();
  Selection before = selection;
  if (!take(std::move(choice))) {
    return;
  }
  if (!std::exchange(pressed->recorded, true)) {  // a stroke of which nothing was taken is none to undo
    strokes.done.push_back(std::move(before));
    strokes.undone.clear();
  }
  if (!selection.has_region) {
    show_region(nullptr);
    return;
  }
  rest(false);
  if (selection.region.kind == RegionSpec::Kind::Vertices) {
    show_by_hand();
  }
}

// --- Keys and motion ------------------------------------------------------------------------------------------------

bool DragSession::key(DragKey key, const Cursor& cursor) {
  Impl& s = *impl_;
  s.refusal.clear();
  switch (key) {  // those that mean something while a step is worked out as well
    case DragKey::Cancel: {
      const bool something = s.in_progress();
      cancel();
      return something;
    }
    case DragKey::Undo:
      undo();
      return true;
    case DragKey::Redo:
      redo();
      return true;
    case DragKey::Grow:
      grow();
      return true;
    case DragKey::Shrink:
      shrink();
      return true;
    default:
      break;
  }
  if (s.waiting()) {
    return false;
  }
  switch (key) {
    case DragKey::Apply:
      s.in<Dragging>() ? apply() : void(s.refusal = messages::kNoMotion);
      return true;
    case DragKey::Pivot:
      set_pivot(s.tools.pivot == Pivot::Centroid ? Pivot::Point
                : s.tools.pivot == Pivot::Point  ? Pivot::Rim
                                                 : Pivot::Centroid);
      return true;
    case DragKey::Brush:
      set_brush_target(s.tools.brush == BrushTarget::Region   ? BrushTarget::Handle
                       : s.tools.brush == BrushTarget::Handle ? BrushTarget::Anchors
                                                              : BrushTarget::Region);
      return true;
    case DragKey::Gizmo:
      show_gizmo(!s.tools.gizmo, s.tools.axes);
      return true;
    case DragKey::NextGroup:
      next_group();
      return true;
    case DragKey::NewRegion:
      new_region();
      return true;
    case DragKey::Curve:
      set_handle_mode(s.selection.mode == HandleMode::Curve ? HandleMode::Vertex : HandleMode::Curve);
      return true;
    default:
      return s.motion_key(key, cursor);
  }
}

/// Keys that begin a motion, or say more of it.
bool DragSession::Impl::motion_key(DragKey key, const Cursor& cursor) {
  if (!drag() && key != DragKey::Rotate && key != DragKey::Scale && key != DragKey::Translate) {
    refusal = messages::kNoMotion;  // an amount from nowhere could be anything
    return true;
  }
  bool begun = true;
  if (key == DragKey::Rotate) {
    begun = begin_by_key(MotionKind::Rotate, cursor);
  } else if (key == DragKey::Scale) {
    begun = begin_by_key(MotionKind::Scale, cursor);
  } else if (key == DragKey::Translate) {
    begun = begin_by_key(MotionKind::Translate, cursor);
  }
  if (!begun) {
    return false;
  }
  DragMotion& motion = drag()->motion;
  if (const std::optional<char> typed = typed_character(key)) {
    motion.type(*typed);
  } else if (key == DragKey::LockX || key == DragKey::LockY || key == DragKey::LockZ) {
    motion.toggle_lock(key == DragKey::LockX ? AxisLock::X : key == DragKey::LockY ? AxisLock::Y : AxisLock::Z);
  } else if (key == DragKey::LockNormal && !motion.toggle_lock(AxisLock::Normal)) {
    refusal = messages::kNoNormal;
  }
  ask();
  return true;
}

bool DragSession::Impl::begin_by_key(MotionKind kind, const Cursor& cursor) {
  if (pressed && !pressed->plain()) {
    end_stroke();
  }
  if (groups().empty() || selection.active < 0) {
    return false;
  }
  return begin(kind, drag() ? drag()->motion.grab() : center(), cursor, false);
}

void DragSession::apply() {
  impl_->refusal.clear();
  if (impl_->in<Dragging>()) {
    impl_->release_motion();
  }
}

void DragSession::cancel() {
  impl_->refusal.clear();
  if (impl_->in_progress()) {
    impl_->drop();
  }
}

}  // namespace lapedit
