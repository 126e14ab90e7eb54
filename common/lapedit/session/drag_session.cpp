// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_session.h"

#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/session/messages.h"
#include "lapedit/session/session_impl.h"

namespace lapedit {

using namespace phase;

// --- What there is to see -------------------------------------------------------------------------------------------

DragSession::DragSession(TriangleMesh mesh, StoredScalar scalar, Callbacks callbacks)
    : impl_(std::make_unique<Impl>(std::move(mesh), scalar, std::move(callbacks))) {}
DragSession::~DragSession() = default;

DragSession::State DragSession::state() const {
  return impl_->waiting()      ? State::Settling
         : impl_->drag()       ? State::Dragging
         : impl_->in<Picked>() ? State::Picked
                               : State::Idle;
}
const TriangleMesh& DragSession::original() const {
  return impl_->original();
}
const TriangleMesh& DragSession::mesh() const {
  return impl_->mesh();
}
const Adjacency& DragSession::adjacency() const {
  return *impl_->adjacency;
}
const Region* DragSession::region() const {
  return impl_->shown.region().get();
}
int DragSession::region_serial() const {
  return impl_->shown.region_serial();
}
const Points& DragSession::pose() const {
  return impl_->shown.pose();
}
int DragSession::pose_serial() const {
  return impl_->shown.serial();
}
const std::vector<std::vector<int>>& DragSession::groups() const {
  return impl_->groups();
}
const std::vector<std::vector<int>>& DragSession::mirrored_groups() const {
  return impl_->all_groups();
}
int DragSession::group_of_image(int group) const {
  return impl_->tools.mirrored ? impl_->tools.mirrored->source()[static_cast<std::size_t>(group)] : group;
}
int DragSession::active_group() const {
  return impl_->selection.active;
}
const DragMotion* DragSession::motion() const {
  const Drag* const drag = impl_->drag();
  return drag ? &drag->motion : nullptr;
}
bool DragSession::preparing() const {
  return impl_->preparation == Impl::Preparation::Running;
}
double DragSession::progress() const {
  return impl_->worker.progress();
}
const char* DragSession::stage() const {
  return impl_->worker.stage();
}
bool DragSession::in_hand() const {
  return impl_->in_hand;
}
bool DragSession::ready() const {
  return impl_->preparation == Impl::Preparation::Done;
}
const std::vector<int>& DragSession::unconnected() const {
  return impl_->unconnected;
}
std::optional<Gizmo> DragSession::gizmo(const Camera& view) const {
  return impl_->gizmo(view);
}
GizmoPart DragSession::gizmo_part() const {
  return impl_->pointer.part;
}
const HoverPreview* DragSession::hover() const {
  return impl_->pointer.preview ? &*impl_->pointer.preview : nullptr;
}
bool DragSession::busy() const {
  return impl_->worker.busy();
}
const DragSettings& DragSession::settings() const {
  return impl_->settings;
}
HandleMode DragSession::handle_mode() const {
  return impl_->selection.mode;
}

Affine DragSession::active_map() const {
  const Drag* const drag = impl_->drag();
  return drag && impl_->selection.active >= 0 ? resolve(drag->motion.transform(), impl_->center())
                                              : Affine(Affine::Identity());
}

std::string DragSession::message() const {
  Impl& s = *impl_;
  if (!s.refusal.empty()) {
    return s.refusal;
  }
  if (s.waiting()) {
    return s.in<Loading>() ? messages::kLoading : messages::kSolving;
  }
  if (const Drag* const drag = s.drag()) {
    return messages::dragging(drag->motion, drag->by_button);
  }
  if (s.selection.next == Selection::Next::Region) {
    return messages::kNextIsRegion;
  }
  if (s.selection.next == Selection::Next::Group) {
    return messages::kNextIsGroup;
  }
  if (s.tools.pivot == Pivot::Point && s.tools.pivot_vertex < 0) {
    return messages::kNextIsPivot;
  }
  if (s.in<Idle>()) {
    return s.selection.has_region ? messages::kPickInRegion : messages::kPickAnywhere;
  }
  if (!s.unconnected.empty()) {
    return messages::unconnected(s.unconnected);
  }
  if (const int free = s.shown.held_by_nothing(); free > 0) {
    return messages::nothing_holds(free);
  }
  return s.selection.mode == HandleMode::Curve && s.selection.curve_end >= 0 ? messages::kLeadCurve
                                                                             : messages::kDragHandle;
}

DragFigures DragSession::figures() const {
  const Impl& s = *impl_;
  DragFigures figures = s.heard;
  if (const Region* const region = s.shown.region().get()) {
    figures.handle = s.shown.count(VertexClass::Handle);
    figures.free = s.shown.count(VertexClass::Free);
    figures.anchors = s.shown.count(VertexClass::Anchor);
    figures.fixed = static_cast<int>(s.mesh().vertices.rows()) - region->size();
  }
  figures.steps = static_cast<int>(s.history.steps().size());
  return figures;
}

// --- Settings -------------------------------------------------------------------------------------------------------

void DragSession::set_settings(const DragSettings& settings) {
  Impl& s = *impl_;
  s.refusal.clear();
  try {
    validate(settings);
  } catch (const EditError& error) {
    s.refusal = error.what();
    return;
  }
  const bool new_radius = settings.radius != s.settings.radius;
  const bool new_discs = settings.handle_share != s.settings.handle_share || settings.softness != s.settings.softness;
  const bool new_rest = settings.padding != s.settings.padding || settings.connect_gap != s.settings.connect_gap ||
                        settings.edit != s.settings.edit;
  s.settings = settings;
  if (s.in<Loading>()) {
    return;
  }
  // While a step is solved for again the worker has that to do, whatever has changed.
  if (s.amendable() && s.history.can_undo() &&
      (new_rest ||
       (new_radius && (s.in<Amending>() || s.history.steps().back().step.region.kind == RegionSpec::Kind::Radius)))) {
    s.amend();
    return;
  }
  // The radius counts for regions that were grown by it, and for what is left of them after a step.
  const bool regrow = new_radius && s.selection.has_region && !s.selection.by_hand &&
                      s.selection.region.kind != RegionSpec::Kind::Component;
  if (regrow) {
    s.selection = with_radius(s.surface(), s.selection);
  } else if (new_discs && !s.amendable()) {
    s.selection = with_discs(s.surface(), s.selection);
  } else if (!new_rest) {
    return;
  }
  if (Picked* const picked = regrow ? s.in<Picked>() : nullptr) {
    picked->amendable = false;
  }
  s.selection = with_padding(std::move(s.selection), settings);
  if (s.groups().empty()) {
    return;
  }
  s.prepare();
  if (s.drag()) {
    s.ask();
  }
}

void DragSession::set_handle_mode(HandleMode mode) {
  impl_->refusal.clear();
  impl_->selection = with_mode(impl_->selection, mode);
}

BrushTarget DragSession::brush_target() const {
  return impl_->tools.brush;
}
void DragSession::set_brush_target(BrushTarget target) {
  impl_->refusal.clear();
  impl_->tools.brush = target;
}

bool DragSession::gizmo_shown() const {
  return impl_->tools.gizmo;
}
GizmoAxes DragSession::gizmo_axes() const {
  return impl_->tools.axes;
}
void DragSession::show_gizmo(bool on, GizmoAxes axes) {
  impl_->tools.gizmo = on;
  impl_->tools.axes = axes;
}

Pivot DragSession::pivot() const {
  return impl_->tools.pivot;
}
void DragSession::set_pivot(Pivot pivot) {
  impl_->refusal.clear();
  impl_->tools.pivot = pivot;
  impl_->tools.pivot_vertex = -1;
}
Vector3 DragSession::pivot_place() const {
  return impl_->pivot_place();
}

const std::optional<MirrorPlane>& DragSession::mirror() const {
  return impl_->tools.mirror;
}
void DragSession::set_mirror(const std::optional<MirrorPlane>& plane) {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.settle_down()) {
    s.tools.mirror = plane;
    s.handles_changed();
  }
}

void DragSession::find_mirror() {
  if (const std::optional<MirrorPlane> found = find_symmetry(mesh())) {
    set_mirror(found);
  } else {
    impl_->refusal = messages::kNotSymmetric;
  }
}

// --- Region and handles ---------------------------------------------------------------------------------------------

/// What a button does to the region.
void DragSession::Impl::change_region(Choice (*choose)(const Surface&, const Selection&)) {
  refusal.clear();
  if (settle_down() && take(choose(surface(), selection))) {
    if (selection.by_hand) {
      show_by_hand();
    }
    handles_changed();
  }
}

void DragSession::set_region(std::vector<int> vertices) {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.settle_down() && s.take(with_region(s.surface(), s.selection, std::move(vertices)))) {
    s.show_by_hand();
    s.handles_changed();
  }
}

void DragSession::set_anchors(std::vector<int> vertices) {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.settle_down() && s.take(with_anchors(s.surface(), s.selection, std::move(vertices)))) {
    s.show_by_hand();
    s.handles_changed();
  }
}

void DragSession::whole_component() {
  impl_->change_region(lapedit::whole_component);
}

void DragSession::grow() {
  impl_->change_region(grown_by_a_ring);
}

void DragSession::shrink() {
  impl_->change_region(shrunk_by_a_ring);
}

void DragSession::clear() {
  impl_->change_region([](const Surface&, const Selection& selection) { return Choice(cleared(selection)); });
}

void DragSession::new_region() {
  impl_->refusal.clear();
  impl_->take(with_next_region(impl_->selection));
}

void DragSession::next_group() {
  impl_->refusal.clear();
  impl_->take(with_next_group(impl_->selection));
}

// --- Steps ----------------------------------------------------------------------------------------------------------

bool DragSession::can_undo() const {
  return impl_->history.can_undo() || impl_->in_progress() || !impl_->strokes.done.empty();
}

bool DragSession::can_redo() const {
  return (impl_->history.can_redo() || !impl_->strokes.undone.empty()) && !impl_->in_progress();
}

void DragSession::undo() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.in_progress()) {
    s.drop();
    return;
  }
  if (s.undo_stroke()) {
    return;
  }
  if (!s.history.can_undo()) {
    s.refusal = messages::kNothingToUndo;
    return;
  }
  const AppliedStep& step = s.history.undo();
  s.show_mesh(step.vertices, step.before, true);
  s.log(messages::step_undone(s.history.steps().size() + 1));
  s.take_over(step, false);
}

void DragSession::redo() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (!s.settle_down() || s.redo_stroke()) {
    return;
  }
  if (!s.history.can_redo()) {
    s.refusal = messages::kNothingToRedo;
    return;
  }
  const AppliedStep& step = s.history.redo();
  s.show_mesh(step.vertices, step.after, true);
  s.log(messages::step_redone(s.history.steps().size()));
  s.take_over(step, true);
}

void DragSession::reset() {
  Impl& s = *impl_;
  cancel();
  const std::size_t count = s.history.steps().size();
  const AppliedStep* first = nullptr;
  while (s.history.can_undo()) {
    first = &s.history.undo();
    s.show_mesh(first->vertices, first->before, !s.history.can_undo());
  }
  if (first) {
    s.log(messages::all_undone(count));
    s.take_over(*first, false);
  }
}

Edit DragSession::recorded() const {
  return impl_->history.recorded();
}

void DragSession::load(Edit edit) {
  Impl& s = *impl_;
  cancel();
  s.pressed.reset();
  s.preparation = Impl::Preparation::Running;
  s.worker.apply({s.history.mesh(), s.adjacency, edit, s.scalar});
  s.phase = Loading{std::move(edit), s.amendable(), {}};
}

// --- News of the worker ---------------------------------------------------------------------------------------------

bool DragSession::poll() {
  MouseEvents waited;
  const bool news = impl_->listen(waited);
  for (const MouseEvent& event : waited) {
    if (event.kind == MouseEvent::Kind::Press) {
      press(event.cursor, event.modifiers);
    } else if (event.kind == MouseEvent::Kind::Move) {
      move(event.cursor);
    } else {
      release(event.cursor);
    }
  }
  return news;
}

void DragSession::finish() {
  Impl& s = *impl_;
  s.end_stroke();
  if (MouseEvents* const waiting = s.waiting()) {
    waiting->clear();
  }
  while (s.in<Releasing>() && s.worker.wait()) {
    poll();
  }
  if (s.in_progress()) {
    s.drop();
  }
}

void DragSession::wait() {
  while (impl_->worker.wait()) {
    poll();
  }
}

}  // namespace lapedit
