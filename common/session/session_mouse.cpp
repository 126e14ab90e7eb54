// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/session_mouse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {

using namespace phase;

namespace {

/// A press this near to a handle vertex grabs its group.
constexpr double kGrabPixels = 6;

double pixels_away(const Cursor& cursor, const Vector3& position) {
  return (cursor.view.pixel(position) - cursor.pixel).norm();
}

/// Returns the point of a bendable curve that a press at the cursor moves, -1 if there is none.
int curve_point_at(const TriangleMesh& mesh, const HandleCurve& curve, const Cursor& cursor) {
  int found = -1;
  double nearest = kGrabPixels;
  for (std::size_t k = 0; curve.bends() && k < curve.points.size(); ++k) {
    const Vector3 position = mesh.vertices.row(curve.path[curve.points[k]]).transpose();
    const double pixels = cursor.view.in_front(position) ? pixels_away(cursor, position) : kGrabPixels;
    if (pixels < nearest) {
      nearest = pixels;
      found = static_cast<int>(k);
    }
  }
  return found;
}

}  // namespace

bool SessionMouse::press(const Cursor& cursor, PressModifiers modifiers) {
  if (!cursor.view.valid()) {
    return true;
  }
  if (solver_.waits() || !waiting_.empty()) {
    waiting_.push_back({Event::Kind::Press, cursor, modifiers});
    return true;
  }
  model_.refusal.clear();
  model_.background.retry();
  if (const Dragging* const drag = solver_.in<Dragging>()) {
    if (!drag->by_button) {
      release_motion();
    }
    return true;
  }
  end_stroke();  // in case its release was lost
  modifiers.add |= model_.tools.paint && modifiers.none();
  if (modifiers.lasso) {
    pressed_ = Press{Vector3::Zero(), -1, cursor, modifiers};
    pressed_->lasso = {cursor.pixel};
    return true;
  }
  if (modifiers.none() && press_gizmo(cursor)) {
    return true;
  }
  if (searching()) {
    // After a step, a press that hit the previous mesh waits for the search over the new one.
    const HoverSearch* const before = model_.background.latest();
    const bool waits = before != nullptr && before->hit(cursor.view, cursor.pixel);
    if (waits) {
      waiting_.push_back({Event::Kind::Press, cursor, modifiers});
    }
    return waits;
  }
  return press_beneath(cursor, modifiers);
}

std::optional<SurfaceHit> SessionMouse::hit(const Cursor& cursor) {
  const HoverSearch* const found = model_.search();
  return found ? found->hit(cursor.view, cursor.pixel) : std::nullopt;
}

void SessionMouse::poll() {
  if (const std::string error = model_.background.poll(); !error.empty()) {
    drop_waiting();
    model_.log(format_text(messages::kNotPossible, error.c_str()));
    model_.refusal = error;
  }
  if (!solver_.waits() && !searching() && !waiting_.empty()) {
    replay();
  }
  take_outlines();
}

bool SessionMouse::searching() {
  return model_.search() == nullptr && !model_.background.failed(model_.history.mesh());
}

bool SessionMouse::wait() {
  const auto ready = [this] { return !searching() && !model_.background.finds_outlines() && waiting_.empty(); };
  const bool was_ready = ready();
  model_.background.wait();
  poll();  // may request other outlines than those that were found
  return !was_ready || !ready();
}

/// Returns the handle group whose mark is under the cursor, -1 if there is none. Marks show through the surface, so a
/// mark slightly behind it can be picked, but not one on the far side. @param hit  of the surface at the cursor
int SessionMouse::group_at(const std::optional<SurfaceHit>& hit, const Cursor& cursor) const {
  const std::vector<std::vector<int>>& groups = model_.groups();
  int found = -1;
  double nearest = kGrabPixels;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const int v : groups[g]) {
      const Vector3 position = model_.mesh().vertices.row(v).transpose();
      if (!cursor.view.in_front(position)) {
        continue;
      }
      const double pixels = pixels_away(cursor, position);
      const double behind = hit ? (position - hit->point).norm() : 0;
      const double reach = std::max(model_.settings.radius, kGrabPixels * cursor.view.pixel_size(position));
      if ((pixels <= nearest && behind <= reach) || (hit && v == hit->vertex)) {
        nearest = pixels;
        found = static_cast<int>(g);
      }
    }
  }
  return found;
}

/// Returns whether a press on a group grabs it: without modifiers, or with Shift to choose among several groups or to
/// move a handle that a plain drag rotates.
bool SessionMouse::grabs(PressModifiers modifiers) const {
  return model_.selection.next != Selection::Next::Region &&
         (modifiers.none() || (modifiers.take && !modifiers.add && (model_.groups().size() > 1 || turns())));
}

/// Returns whether a plain drag of a handle rotates it about the pivot, which keeps the length of a limb.
bool SessionMouse::turns() const {
  return !model_.tools.paint && (model_.tools.pivot_vertex >= 0 ||
                                 (model_.tools.pivot == Pivot::Boundary && model_.shown.region() != nullptr));
}

/// Handles a press that is not on the gizmo. @return as press()
bool SessionMouse::press_beneath(const Cursor& cursor, PressModifiers modifiers) {
  const std::optional<SurfaceHit> hit = this->hit(cursor);
  if (model_.tools.awaits_pivot() && modifiers.none()) {
    if (hit) {
      model_.tools.pivot_vertex = hit->vertex;
    } else {
      model_.refusal = messages::kNoSurface;
    }
    return hit.has_value();
  }
  const int grabbed = grabs(modifiers) ? group_at(hit, cursor) : -1;
  if (grabbed >= 0) {
    if (modifiers.none()) {
      model_.selection = with_grabbed(model_.selection, grabbed);
    }
    pressed_ = Press{hit ? hit->point : cursor.view.beside(model_.center(), cursor.pixel), hit ? hit->vertex : -1,
                     cursor, modifiers};
    pressed_->on_handle = modifiers.none();
    pressed_->group = grabbed;
    const HandleCurve& curve = model_.selection.discs.curves[grabbed];
    pressed_->curve_point = modifiers.none() ? curve_point_at(model_.mesh(), curve, cursor) : -1;
    pressed_->moves = turns() && !modifiers.none();
    if (turns() && modifiers.none() && pressed_->curve_point < 0) {
      pressed_->kind = MotionKind::Rotate;
    }
  } else if (hit) {
    press_surface(*hit, cursor, modifiers);
  } else {
    model_.refusal = messages::kNoSurface;
    return false;
  }
  return true;
}

void SessionMouse::move(const Cursor& cursor) {
  if (!cursor.view.valid()) {
    return;
  }
  if (!waiting_.empty()) {  // a stroke needs each of them
    waiting_.push_back({Event::Kind::Move, cursor, {}});
  }
  if (solver_.waits() || !waiting_.empty()) {
    return;
  }
  if (lasso() != nullptr) {
    pressed_->lasso.push_back(cursor.pixel);
    return;
  }
  if (pressed_ && !pressed_->modifiers.none() && !pressed_->moves) {
    brush(cursor);
    return;
  }
  if (pressed_ && !solver_.in<Dragging>()) {
    if (pressed_->moves) {
      model_.selection = with_grabbed(model_.selection, pressed_->group);
    }
    // The motion begins where the button was pressed, however long the first move is.
    if (!pressed_->draggable || !solver_.begin(pressed_->kind, pressed_->point, pressed_->cursor, true)) {
      pressed_->draggable = false;  // the refusal is reported already
      return;
    }
    if (pressed_->axis) {
      solver_.in<Dragging>()->motion.hold(*pressed_->axis);
    }
    if (pressed_->curve_point >= 0 && model_.selection.along.empty()) {
      solver_.bend(pressed_->curve_point);
    }
  }
  Dragging* const drag = solver_.in<Dragging>();
  if (drag && (pressed_ || !drag->by_button)) {
    drag->motion.move(snapped(cursor, drag->motion.kind()));
    solver_.request();
  }
}

Cursor SessionMouse::snapped(const Cursor& cursor, MotionKind kind) const {
  Cursor at = cursor;
  if (model_.tools.targets && kind == MotionKind::Translate) {
    at.target = model_.tools.targets->at(cursor.view, cursor.pixel);
  }
  return at;
}

bool SessionMouse::hover(const Cursor& cursor, PressModifiers modifiers) {
  const bool was = preview_.has_value();
  const GizmoElement before = element_;
  if (!cursor.view.valid() || solver_.in_progress() || pressed_ || !waiting_.empty()) {
    preview_.reset();
    return was;
  }
  const std::optional<Gizmo> gizmo = model_.gizmo(cursor.view);
  element_ = element_at(gizmo, cursor);
  if (element_ != GizmoElement::None) {
    preview_.reset();
  } else {
    look(cursor, modifiers);
  }
  return was || preview_ || before != element_;
}

void SessionMouse::leave() {
  preview_.reset();
  element_ = GizmoElement::None;
}

std::optional<Vector3> SessionMouse::surface_at(const Cursor& cursor, PressModifiers modifiers) {
  const std::optional<SurfaceHit> hit = solver_.in_progress() ? std::nullopt : this->hit(cursor);
  modifiers.add |= model_.tools.paint && modifiers.none();
  const bool on_mark = element_at(model_.gizmo(cursor.view), cursor) != GizmoElement::None ||
                       (grabs(modifiers) && group_at(hit, cursor) >= 0);
  return hit && !on_mark ? std::optional(hit->point) : std::nullopt;
}

void SessionMouse::release(const Cursor& cursor) {
  if (!waiting_.empty()) {
    waiting_.push_back({Event::Kind::Release, cursor, {}});
    return;
  }
  if (solver_.waits() || !pressed_) {
    pressed_.reset();
    return;
  }
  if (Dragging* const drag = solver_.in<Dragging>()) {
    if (cursor.view.valid()) {
      drag->motion.move(snapped(cursor, drag->motion.kind()));
    }
    release_motion();
    return;
  }
  if (lasso() != nullptr) {
    close_lasso(cursor);
    return;
  }
  const Press press = *pressed_;
  if (press.brushed || (model_.tools.paint && !press.modifiers.none())) {  // a click paints a single patch
    brush(cursor);
    end_stroke();
    return;
  }
  end_stroke();
  if (press.on_handle && press.draggable) {
    model_.tools.gizmo_by_click |= !std::exchange(model_.tools.gizmo, true);
  } else if (press.on_gizmo) {  // a click picks what is behind the gizmo
    press_beneath(press.cursor, {});
    pressed_.reset();
  } else if (!press.modifiers.none()) {
    click(press);
  }
}

void SessionMouse::end_stroke() {
  const bool brushed = pressed_ && pressed_->brushed;
  pressed_.reset();
  if (brushed) {
    solver_.handles_changed();
  }
}

/// Returns the element of the gizmo under the cursor; none over another handle, since a press grabs that handle.
GizmoElement SessionMouse::element_at(const std::optional<Gizmo>& gizmo, const Cursor& cursor) {
  const GizmoElement element = gizmo ? gizmo_element_at(*gizmo, cursor) : GizmoElement::None;
  if (element == GizmoElement::None || model_.groups().size() == 1) {
    return element;
  }
  const int group = group_at(hit(cursor), cursor);
  return group < 0 || group == model_.selection.active ? element : GizmoElement::None;
}

/// Handles a press on an arrow, a ring or the scale handle. @return whether there was one under the cursor
bool SessionMouse::press_gizmo(const Cursor& cursor) {
  const std::optional<Gizmo> gizmo = model_.gizmo(cursor.view);
  element_ = element_at(gizmo, cursor);
  if (element_ == GizmoElement::None) {
    return false;
  }
  pressed_ = Press{gizmo->center, -1, cursor, {}};
  pressed_->on_gizmo = true;
  pressed_->kind = kind_of(element_);
  pressed_->axis = axis_of(*gizmo, element_);
  return true;
}

/// Returns what a press at the cursor would take. The radius of a new region is that of the protrusion there, unless
/// the user has set it. The region has to be visible: the radius is at least some pixels, and less than the view.
HoverQuery SessionMouse::query(const SurfaceHit& hit, const Camera& view, bool with_region) const {
  constexpr double kSmallest = 0.125, kLargest = 3;  // times the usual radius
  constexpr double kPixels = 16, kOfView = 0.45;
  const DragSettings& settings = model_.settings;
  const double usual = with_region ? settings.first_radius : 0;
  const bool is_disc = model_.selection.mode == HandleMode::Vertex;
  HoverQuery query;
  query.vertex = hit.vertex;
  query.with_region = with_region;
  query.radius = usual > 0 ? usual : settings.radius;
  query.disc = is_disc ? disc_radius(settings) : 0;
  query.mirror = model_.tools.mirror;
  if (usual > 0 && is_disc) {
    const double pixel = view.pixel_size(hit.point);
    query.disc = settings.handle_fraction;
    query.largest = std::min(kLargest * usual, kOfView * view.height() * pixel);
    query.smallest = std::min(std::max(kSmallest * usual, kPixels * pixel), query.largest);
  }
  return query;
}

/// Copies the outlines to the preview once they are found, unless a press waits for others.
void SessionMouse::take_outlines() {
  if (preview_ && wanted_ && waiting_.empty()) {
    if (const HoverOutlines* const found = model_.background.outlines(*wanted_)) {
      static_cast<HoverOutlines&>(*preview_) = *found;
    }
  }
}

/// Finds the surface under the cursor, and what a press would pick there.
void SessionMouse::look(const Cursor& cursor, PressModifiers modifiers) {
  HoverSearch* const search = model_.search();
  // Not hit(): the search may become ready between two calls.
  const std::optional<SurfaceHit> hit = search ? search->hit(cursor.view, cursor.pixel) : std::nullopt;
  if (!hit) {
    preview_.reset();
    return;
  }
  using Kind = HoverPreview::Kind;
  HoverPreview& preview = preview_ ? *preview_ : preview_.emplace();
  modifiers.add |= model_.tools.paint && modifiers.none();
  preview.group = grabs(modifiers) ? group_at(hit, cursor) : -1;
  preview.kind = preview.group >= 0                                               ? Kind::Group
                 : !modifiers.none()                                              ? Kind::Brush
                 : takes_region(solver_.surface(), model_.selection, hit->vertex) ? Kind::Region
                                                                                  : Kind::Handle;
  preview_curve(*search, *hit, cursor, preview);
  preview.point = hit->point;
  preview.vertex = hit->vertex;
  const Vector3 normal = area_normal(model_.mesh(), hit->face);
  const double length = normal.norm();
  preview.normal = length > 0 && std::isfinite(length) ? Vector3(normal / length) : Vector3(Vector3::Zero());
  if (preview.kind == Kind::Region || preview.kind == Kind::Handle) {
    wanted_ = query(*hit, cursor.view, preview.kind == Kind::Region);
    take_outlines();
  } else {
    wanted_.reset();
    static_cast<HoverOutlines&>(preview) = HoverOutlines();
  }
}

/// Previews the next piece of a curve, or marks the point of a curve under the cursor.
void SessionMouse::preview_curve(HoverSearch& search, const SurfaceHit& hit, const Cursor& cursor,
                                 HoverPreview& preview) {
  const Selection& selection = model_.selection;
  const bool next = selection.leads_curve() &&
                    (preview.kind == HoverPreview::Kind::Handle || preview.kind == HoverPreview::Kind::Region);
  search.path(next ? selection.curve_end : -1, hit.vertex, preview.path);
  preview.curve_point.reset();
  if (preview.kind == HoverPreview::Kind::Group && selection.along.empty()) {
    const HandleCurve& curve = selection.discs.curves[preview.group];
    if (const int point = curve_point_at(model_.mesh(), curve, cursor); point >= 0) {
      preview.curve_point = model_.mesh().vertices.row(curve.path[curve.points[point]]).transpose();
    }
  }
}

/// Handles a press on the surface outside all handles.
void SessionMouse::press_surface(const SurfaceHit& hit, const Cursor& cursor, PressModifiers modifiers) {
  if (!modifiers.none()) {
    pressed_ = Press{hit.point, hit.vertex, cursor, modifiers};
    return;  // a stroke follows or, on release, a click
  }
  if (model_.settings.first_radius > 0 && takes_region(solver_.surface(), model_.selection, hit.vertex)) {
    const HoverOutlines* const found = model_.background.outlines(query(hit, cursor.view, true));
    if (found == nullptr) {  // the press came before its preview
      waiting_.push_back({Event::Kind::Press, cursor, modifiers});
      return;
    }
    model_.settings.radius = found->radius;
  }
  pressed_ = Press{hit.point, hit.vertex, cursor, modifiers};
  const bool taken = model_.take(pick(solver_.surface(), model_.selection, hit.vertex));
  pressed_->draggable = taken && model_.selection.mode == HandleMode::Vertex;
  if (taken) {
    solver_.handles_changed();
  }
}

/// Handles a click with Ctrl or Shift.
void SessionMouse::click(const Press& press) {
  if (press.group >= 0 && model_.groups().size() > 1) {
    model_.selection = with_group_chosen(model_.selection, press.group);
    return;
  }
  const auto choose = press.modifiers.add ? add_to_handle : take_from_handle;
  if (!model_.take(choose(solver_.surface(), model_.selection, press.vertex))) {
    return;
  }
  if (model_.groups().empty() && model_.shown.region()) {
    model_.show_by_hand();
  }
  solver_.handles_changed();
}

/// Paints the surface between the last position of the stroke and the cursor.
void SessionMouse::brush(const Cursor& cursor) {
  constexpr double kStep = 2;  // pixels between two hits: thinner parts may be missed
  pressed_->brushed = true;
  const HoverSearch* const search = model_.search();
  const Cursor last = std::exchange(pressed_->cursor, cursor);
  const Vector2 from = last.view == cursor.view ? last.pixel : cursor.pixel;
  const double steps = std::ceil((cursor.pixel - from).norm() / kStep);
  std::vector<SurfaceHit> hits;
  for (double step = 0; search != nullptr && step <= steps; ++step) {
    const Vector2 pixel = from + step / std::max(steps, 1.0) * (cursor.pixel - from);
    if (const std::optional<SurfaceHit> hit = search->hit(cursor.view, pixel)) {
      hits.push_back(*hit);
    }
  }
  if (hits.empty()) {
    return;
  }
  const std::vector<int> patch = brushed_vertices(model_.mesh(), *model_.adjacency, search->faces(), cursor.view, hits,
                                                  from, cursor.pixel, model_.settings.brush_pixels);
  paint(patch);
}

/// Paints what is visible inside the lasso.
void SessionMouse::close_lasso(const Cursor& cursor) {
  const HoverSearch* const search = model_.search();
  if (search == nullptr) {
    pressed_.reset();
    model_.refusal = messages::kSearching;
    return;
  }
  pressed_->brushed = true;
  const std::vector<int> inside =
      enclosed_vertices(model_.mesh(), *model_.adjacency, search->faces(), cursor.view, pressed_->lasso);
  paint(inside);
  end_stroke();
}

/// Adds vertices to the brush's target, or removes them.
void SessionMouse::paint(const std::vector<int>& patch) {
  if (patch.empty()) {
    return;
  }
  const bool add = pressed_->modifiers.add;
  const BrushTarget target = model_.tools.brush();
  Choice choice = brushed(solver_.surface(), model_.selection, target, patch, add);
  model_.refusal.clear();
  Selection before = model_.selection;
  if (!model_.take(std::move(choice))) {
    if (pressed_->recorded) {
      model_.refusal.clear();  // an end of the stroke that adds nothing needs no explanation
    }
    return;
  }
  if (!std::exchange(pressed_->recorded, true)) {  // a stroke without effect is not an action
    model_.timeline.add({messages::kStrokeOf[static_cast<int>(target)], false, std::move(before)});
  }
  solver_.rest(false);
  if (!model_.selection.has_region) {
    model_.show_region(nullptr);
  } else if (model_.selection.region.kind == RegionSpec::Kind::Vertices) {
    model_.show_by_hand();
  }
}

void SessionMouse::release_motion() {
  pressed_.reset();
  element_ = GizmoElement::None;
  solver_.release();
}

void SessionMouse::forget() {
  pressed_.reset();
  element_ = GizmoElement::None;
  waiting_.clear();
}

void SessionMouse::replay() {
  for (const Event& event : std::exchange(waiting_, {})) {
    if (event.kind == Event::Kind::Press) {
      press(event.cursor, event.modifiers);
    } else if (event.kind == Event::Kind::Move) {
      move(event.cursor);
    } else {
      release(event.cursor);
    }
  }
}

}  // namespace lapedit
