// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/edit/positions.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {

using namespace phase;

DragSession::DragSession(TriangleMesh mesh, StoredScalar scalar, const Callbacks& callbacks)
    : model_(std::move(mesh), scalar, callbacks), solver_(model_, callbacks.wake), mouse_(model_, solver_) {}

// --- What there is to see -------------------------------------------------------------------------------------------

DragSession::State DragSession::state() const {
  return solver_.waits()        ? State::Settling
         : solver_.moving()     ? State::Dragging
         : solver_.in<Picked>() ? State::Picked
                                : State::Idle;
}

int DragSession::group_of_image(int group) const {
  return model_.tools.mirrored ? model_.tools.mirrored->source()[group] : group;
}

const DragMotion* DragSession::motion() const {
  const Dragging* const drag = solver_.in<Dragging>();
  return drag ? &drag->motion : nullptr;
}

Affine DragSession::active_map() const {
  return motion() && model_.selection.active >= 0 ? resolve(motion()->transform(), model_.center()).map
                                                  : Affine(Affine::Identity());
}

std::string DragSession::message() const {
  if (!model_.refusal.empty()) {
    return model_.refusal;
  }
  if (solver_.waits()) {
    return solver_.in<Loading>() ? messages::kLoading : messages::kSolving;
  }
  if (const Dragging* const drag = solver_.in<Dragging>()) {
    const std::string text = format_text(messages::kDragging, drag->motion.text().c_str(),
                                         drag->by_button ? "release" : "click or press Return");
    return solver_.figures().full_frames ? text + messages::kFullFrames : text;
  }
  std::string text = next_click();
  if (model_.tools.pivot != Pivot::Centroid && !model_.tools.awaits_pivot() && !model_.tools.paint) {
    text += model_.tools.pivot == Pivot::Boundary ? messages::kTurnsAboutBoundary : messages::kTurnsAboutPoint;
  }
  return text;
}

/// Describes the effect of the next click.
std::string DragSession::next_click() const {
  const Selection& selection = model_.selection;
  if (model_.tools.paint) {
    return messages::kPaints[static_cast<int>(*model_.tools.paint)];
  }
  if (selection.next == Selection::Next::Region) {
    return messages::kNextIsRegion;
  }
  if (selection.next == Selection::Next::Group) {
    return messages::kNextIsGroup;
  }
  if (model_.tools.awaits_pivot()) {
    return messages::kNextIsPivot;
  }
  if (model_.groups().empty()) {
    return selection.has_region ? messages::kPickInRegion : messages::kPickAnywhere;
  }
  if (!model_.unconnected.empty()) {
    return format_text(messages::kUnconnected, model_.unconnected.size(), model_.unconnected.front());
  }
  if (const int free = model_.shown.held_by_nothing(); free > 0) {
    return format_text(messages::kNothingHolds, free);
  }
  if (selection.mode == HandleMode::Curve && selection.curve_end >= 0) {
    return messages::kLeadCurve;
  }
  if (selection.groups.size() > 1) {
    return format_text(messages::kDragHandles, selection.along.size() + 1, selection.groups.size());
  }
  return selection.discs.curves.front().bends() ? messages::kBendCurve : messages::kDragHandle;
}

// --- Settings -------------------------------------------------------------------------------------------------------

void DragSession::set_settings(const DragSettings& settings, bool passing) {
  model_.refusal.clear();
  try {
    validate(settings);
  } catch (const EditError& error) {
    model_.refusal = error.what();
    return;
  }
  const DragSettings before = std::exchange(model_.settings, settings);
  if (settings.radius != before.radius && settings.radius != settings.first_radius) {
    model_.settings.first_radius = 0;  // the user sets the radius from now on
  }
  if (solver_.in<Loading>() || solver_.in<Dragging>()) {
    model_.settings.edit.detail = before.edit.detail;
  }
  Selection& selection = model_.selection;
  switch (effect_of_settings(before, passing)) {
    case Effect::Nothing:
      return;
    case Effect::LastStep:
      return solver_.adjust(passing);
    case Effect::Detail:
      return solver_.begin_detail(passing);
    case Effect::Radius:
      selection = with_radius(solver_.surface(), selection);
      if (solver_.in<Picked>()) {
        solver_.rest(false);
      }
      break;
    case Effect::Discs:
      selection = with_discs(solver_.surface(), selection);
      break;
    case Effect::Options:
      break;
  }
  selection = with_padding(std::move(selection), settings);
  if (selection.groups.empty()) {
    return;
  }
  const bool was_dragging = solver_.in<Dragging>() != nullptr;
  solver_.prepare();
  if (solver_.in<Dragging>()) {
    solver_.request();
  } else if (was_dragging) {
    mouse_.forget();
  }
}

/// Returns what the settings of the model affect, which were others before.
DragSession::Effect DragSession::effect_of_settings(const DragSettings& before, bool passing) const {
  const DragSettings& now = model_.settings;
  const bool new_radius = now.radius != before.radius;
  const bool new_discs = disc_radius(now) != disc_radius(before) || now.falloff != before.falloff;
  const bool new_options = now.padding != before.padding || now.connect_gap != before.connect_gap ||
                           now.pieces != before.pieces || now.edit != before.edit;
  if (solver_.in<Loading>()) {
    return Effect::Nothing;
  }
  // The radius affects the last step only if it is being solved again or has a radius.
  if (const Adjusting* const adjusting = solver_.in<Adjusting>()) {
    return new_options || new_radius || (adjusting->open && !passing) ? Effect::LastStep : Effect::Nothing;
  }
  if (solver_.adjustable() && model_.history.can_undo() &&
      (new_options || (new_radius && model_.history.steps().back().step.region.kind == RegionSpec::Kind::Radius))) {
    return Effect::LastStep;
  }
  if (now.edit.detail != before.edit.detail) {
    return Effect::Detail;
  }
  // It applies to regions that were grown by it, also after a step.
  const Selection& selection = model_.selection;
  if (new_radius && selection.has_region && !selection.by_hand &&
      selection.region.kind != RegionSpec::Kind::Component) {
    return Effect::Radius;
  }
  return new_discs && !solver_.adjustable() ? Effect::Discs : new_options ? Effect::Options : Effect::Nothing;
}

DragSettings DragSession::settings_at_cursor() const {
  DragSettings settings = model_.settings;
  if (const HoverPreview* const preview = hover();
      preview && preview->kind == HoverPreview::Kind::Region && preview->radius > 0 && !model_.selection.has_region) {
    settings.radius = preview->radius;
  }
  return settings;
}

void DragSession::set_tools(const Tools& tools) {
  model_.refusal.clear();
  ToolState& now = model_.tools;
  if (tools.paint != now.paint && settle_down()) {
    now.paint = tools.paint;
  }
  now.gizmo_by_click &= tools.gizmo == now.gizmo;
  now.gizmo = tools.gizmo;
  now.axes = tools.axes;
  if (tools.pivot != now.pivot) {
    now.pivot = tools.pivot;
    now.pivot_vertex = -1;
  }
  if (tools.snaps != now.snaps) {
    now.snaps = tools.snaps;
    now.targets = nullptr;
  }
  if (!(tools.mirror == now.mirror)) {
    set_mirror(tools.mirror);
  }
}

void DragSession::set_mode(HandleMode mode) {
  model_.refusal.clear();
  model_.selection = with_mode(model_.selection, mode);
}

void DragSession::take_by_click(HandleMode mode) {
  set_mode(mode);
  model_.selection.next = Selection::Next::Handle;
}

void DragSession::set_mirror(const std::optional<MirrorPlane>& plane) {
  if (settle_down()) {
    model_.tools.mirror = plane;
    solver_.handles_changed();
    const double off = plane ? asymmetry(mesh(), *plane) : 0;
    if (off > kSymmetric && model_.refusal.empty()) {
      model_.refusal = format_text(messages::kAsymmetric, 100 * off);
    }
  }
}

void DragSession::find_mirror() {
  if (const std::optional<MirrorPlane> found = find_symmetry(mesh())) {
    set_mirror(found);
  } else {
    model_.refusal = messages::kNotSymmetric;
  }
}

void DragSession::set_last_step(const HandleTransform& motion, double fraction, bool passing) {
  model_.refusal.clear();
  const std::optional<LastStep> last = last_step();
  if (!last) {
    model_.refusal = messages::kNoLastStep;
  } else if (!(motion.scale > 0) || !std::isfinite(motion.scale)) {
    model_.refusal =
        format_text(messages::kOutOfRange, "factor of the last step", motion.scale, "a finite number greater than 0");
  } else if (!(fraction >= 0 && fraction <= 1)) {
    model_.refusal = format_text(messages::kOutOfRange, "fraction of the last step", fraction, "a number from 0 to 1");
  } else if (!motion.translation.allFinite() || !std::isfinite(motion.degrees)) {
    model_.refusal = format_text(messages::kOutOfRange, "displacement of the last step",
                                 motion.translation.norm() + motion.degrees, "finite numbers");
  } else if (last->single && (motion.degrees != 0 || motion.scale != 1)) {
    model_.refusal = format_text(messages::kSingleVertex, motion.degrees != 0 ? "Turning" : "Scaling",
                                 model_.active_group().front());
  } else {
    solver_.adjust_path(motion, fraction, passing);
  }
}

// --- Region and handles ---------------------------------------------------------------------------------------------

std::string DragSession::warning() const {
  const bool of_what_is_seen = solver_.in<Dragging>() || solver_.adjustable();
  return of_what_is_seen && model_.refusal.empty() ? solver_.figures().advice() : std::string();
}

/// Cancels a drag in progress. @return whether region and handles may change now
bool DragSession::settle_down() {
  model_.refusal.clear();
  if (solver_.waits()) {
    model_.refusal = messages::kStillSettling;
    return false;
  }
  cancel();
  mouse_.end_stroke();
  return true;
}

/// Applies a change of the region, or reports why it is refused.
template <class Choose>
bool DragSession::change_region(const Choose& choose) {
  if (!settle_down() || !model_.take(choose(solver_.surface(), model_.selection))) {
    return false;
  }
  if (model_.selection.by_hand) {
    model_.show_by_hand();
  }
  solver_.handles_changed();
  return true;
}

void DragSession::set_painted(BrushTarget target, std::vector<int> vertices) {
  model_.weld.to_representatives(vertices);
  const auto choose = target == BrushTarget::Region   ? with_region
                      : target == BrushTarget::Handle ? with_handle
                                                      : with_anchors;
  change_region([&](const Surface& s, const Selection& now) { return choose(s, now, std::move(vertices)); });
}

void DragSession::change_painted(PaintChange change) {
  Selection before = model_.selection;
  const BrushTarget target = model_.tools.brush();
  if (change_region([&](const Surface& s, const Selection& now) { return with_painted(s, now, target, change); })) {
    model_.timeline.add({messages::kStrokeOf[static_cast<int>(target)], false, std::move(before)});
  }
}

void DragSession::whole_component() {
  change_region(lapedit::whole_component);
}

void DragSession::clear() {
  change_region([](const Surface&, const Selection& now) { return Choice(cleared(now)); });
}

void DragSession::keep_painted() {
  change_region([](const Surface& s, const Selection& now) { return Choice(only_painted(now, s.settings)); });
}

Inheritance DragSession::inheritance() const {
  return {tools(), settings(), saved(), recorded(), only_painted(selection(), settings())};
}

void DragSession::inherit(const Inheritance& before) {
  Tools tools = before.tools;
  tools.pivot = tools.pivot == Pivot::Point ? Pivot::Centroid : tools.pivot;
  set_tools(tools);
  DragSettings settings = before.settings;
  if (settings.first_radius > 0) {  // the radius is that of a protrusion
    settings.radius = settings.first_radius;
  }
  settings.edit.detail = 1;
  set_settings(settings);
  earlier_ = before.saved;
  const Edit now = recorded();
  if (now.mesh_vertices == before.recorded.mesh_vertices && now.connectivity == before.recorded.connectivity) {
    Selection painted = before.painted;
    painted.held = painted.region.held = model_.weld.representatives(std::move(painted.held));
    painted.region.vertices = model_.weld.representatives(std::move(painted.region.vertices));
    change_region([&painted](const Surface&, const Selection&) { return Choice(std::move(painted)); });
  }
  if (const std::size_t lost = before.recorded.steps.size(); lost > 0) {
    model_.refusal = format_text(messages::kStepsLost, lost, lost == 1 ? "step" : "steps", lost == 1 ? "it" : "them");
    model_.log(model_.refusal);
  }
}

// --- Steps ----------------------------------------------------------------------------------------------------------

bool DragSession::can_undo() const {
  return solver_.in_progress() || !model_.timeline.done().empty();
}

bool DragSession::can_redo() const {
  return !model_.timeline.undone().empty() && !solver_.in_progress();
}

void DragSession::undo() {
  if (solver_.in_progress()) {
    cancel();
  } else if (model_.timeline.done().empty()) {
    model_.refusal = messages::kNothingToUndo;
  } else {
    go_to(model_.timeline.done().size() - 1);
  }
}

void DragSession::redo() {
  if (!settle_down()) {
    return;
  }
  if (model_.timeline.undone().empty()) {
    model_.refusal = messages::kNothingToRedo;
  } else {
    go_to(model_.timeline.done().size() + 1);
  }
}

/// Prepares the region once, however many actions are undone or redone.
void DragSession::go_to(std::size_t actions) {
  if (!settle_down()) {
    return;
  }
  const std::size_t before = timeline().done().size(), wanted = std::min(actions, before + timeline().undone().size());
  const bool again = wanted > before;
  bool is_step = false;
  while (timeline().done().size() != wanted) {
    is_step = again ? model_.redo() : model_.undo();
  }
  if (wanted == before) {
    return;
  }
  if (is_step) {
    solver_.take_over(again);
    return;
  }
  if (model_.selection.region.kind == RegionSpec::Kind::Vertices && model_.selection.has_region) {
    model_.show_by_hand();
  } else {
    model_.show_region(nullptr);
  }
  solver_.handles_changed();
}

Edit DragSession::saved() const {
  return model_.history.can_undo() ? with_positions(original(), *model_.adjacency, recorded()) : earlier_;
}

void DragSession::load(Edit edit, const std::string& off_surface) {
  cancel();
  mouse_.forget();
  try {
    solver_.load(located(*model_.given_mesh(), *model_.given_adjacency, std::move(edit)));
  } catch (const OffSurface& error) {
    model_.refusal = error.what() + off_surface;
  } catch (const EditError& error) {
    model_.refusal = error.what();
  }
}

// --- Answers of the solver ------------------------------------------------------------------------------------------

bool DragSession::poll() {
  const bool was_in_progress = solver_.in_progress();
  const SessionSolver::Response response = solver_.poll();
  if (was_in_progress && !solver_.in_progress()) {
    // Without a step, the solver refused the request.
    response == SessionSolver::Response::Step ? mouse_.replay() : mouse_.forget();
  }
  mouse_.poll();
  return response != SessionSolver::Response::None;
}

bool DragSession::finish(std::chrono::milliseconds longest) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point until = Clock::now() + longest;
  const auto is_released = [this] { return solver_.in<Dragging>() && solver_.waits(); };
  mouse_.end_stroke();
  mouse_.forget();
  while (is_released() && solver_.wait(std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()))) {
    poll();
  }
  if (is_released()) {
    model_.back_to_mesh(true);  // until the exact pose is there
    return false;
  }
  cancel();
  return true;
}

void DragSession::wait() {
  do {
    while (solver_.wait()) {
      poll();
    }
  } while (mouse_.wait());
}

// --- Keys and motion ------------------------------------------------------------------------------------------------

bool DragSession::key(DragKey key, const Cursor& cursor) {
  model_.refusal.clear();
  switch (key) {  // keys that also work while a step is being solved
    case DragKey::Cancel: {
      if (solver_.in_progress() || mouse_.has_waiting()) {
        cancel();
        return true;
      }
      const bool painting = model_.tools.paint.has_value();
      set(&Tools::paint, std::nullopt);
      return painting;
    }
    case DragKey::Undo:
      undo();
      return true;
    case DragKey::Redo:
      redo();
      return true;
    case DragKey::Grow:
      change_region(grown_by_a_ring);
      return true;
    case DragKey::Shrink:
      change_region(shrunk_by_a_ring);
      return true;
    default:
      break;
  }
  if (solver_.waits()) {
    return false;
  }
  switch (key) {
    case DragKey::Apply:
      solver_.moving() ? mouse_.release_motion() : void(model_.refusal = messages::kNoMotion);
      return true;
    case DragKey::Pivot:
      set(&Tools::pivot, model_.tools.pivot == Pivot::Centroid ? Pivot::Point
                         : model_.tools.pivot == Pivot::Point  ? Pivot::Boundary
                                                               : Pivot::Centroid);
      return true;
    case DragKey::Brush:
      set(&Tools::paint, !model_.tools.paint                          ? std::optional(BrushTarget::Region)
                         : *model_.tools.paint == BrushTarget::Region ? std::optional(BrushTarget::Handle)
                         : *model_.tools.paint == BrushTarget::Handle ? std::optional(BrushTarget::Anchors)
                                                                      : std::nullopt);
      return true;
    case DragKey::Gizmo:
      set(&Tools::gizmo, !model_.tools.gizmo);
      return true;
    case DragKey::NextGroup:
      model_.take(with_next(model_.selection, Selection::Next::Group));
      return true;
    case DragKey::NewRegion:
      model_.take(with_next(model_.selection, Selection::Next::Region));
      return true;
    case DragKey::Curve:
      set_mode(model_.selection.mode == HandleMode::Curve ? HandleMode::Vertex : HandleMode::Curve);
      return true;
    default:
      return motion_key(key, cursor);
  }
}

/// Handles keys that begin a motion or change it.
bool DragSession::motion_key(DragKey key, const Cursor& cursor) {
  const bool begins = key == DragKey::Translate || key == DragKey::Rotate || key == DragKey::Scale;
  if (!begins && !solver_.in<Dragging>()) {
    model_.refusal = messages::kNoMotion;  // a number without a motion has no meaning
    return true;
  }
  if (begins && !begin_by_key(key == DragKey::Rotate  ? MotionKind::Rotate
                              : key == DragKey::Scale ? MotionKind::Scale
                                                      : MotionKind::Translate,
                              cursor)) {
    return false;
  }
  DragMotion& motion = solver_.in<Dragging>()->motion;
  if (const std::optional<char> typed = typed_character(key)) {
    motion.type(*typed);
  } else if (key == DragKey::LockX || key == DragKey::LockY || key == DragKey::LockZ) {
    motion.toggle_lock(key == DragKey::LockX ? AxisLock::X : key == DragKey::LockY ? AxisLock::Y : AxisLock::Z);
  } else if (key == DragKey::LockNormal && !motion.toggle_lock(AxisLock::Normal)) {
    model_.refusal = messages::kNoNormal;
  }
  solver_.request();
  return true;
}

bool DragSession::begin_by_key(MotionKind kind, const Cursor& cursor) {
  if (mouse_.brushing()) {
    mouse_.end_stroke();
  }
  if (!model_.has_active_group()) {
    return false;
  }
  return solver_.begin(kind, solver_.in<Dragging>() ? solver_.in<Dragging>()->motion.grab() : model_.center(), cursor,
                       false);
}

void DragSession::cancel() {
  model_.refusal.clear();
  mouse_.drop_waiting();
  if (solver_.in_progress()) {
    mouse_.forget();
    solver_.discard();
  }
}

}  // namespace lapedit
