// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_session.h"

#include <algorithm>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/edit/solver_thread.h"
#include "lapedit/session/history.h"
#include "lapedit/session/messages.h"
#include "lapedit/session/phases.h"
#include "lapedit/session/picking.h"
#include "lapedit/session/selection.h"
#include "lapedit/session/shown_region.h"

namespace lapedit {
namespace {

using namespace phase;

/// A mouse button that is down.
struct Press {
  Vector3 point;    // what was grabbed
  int vertex = -1;  // nearest to it
  Cursor cursor;
  PressModifiers modifiers;
  bool draggable = true;
  bool brushed = false;

  bool plain() const { return !modifiers.add && !modifiers.take; }
};

TriangleMesh checked(TriangleMesh mesh) {
  validate(mesh);
  return mesh;
}

}  // namespace

/// What the session is doing is its phase; the rest is what lasts from one phase to the next.
struct DragSession::Impl {
  enum class Preparation { None, Running, Done };

  Callbacks callbacks;
  StoredScalar scalar;
  History history;
  std::shared_ptr<const Adjacency> adjacency;
  DragSettings settings;
  Selection selection;
  Phase phase;
  std::optional<Press> pressed;
  std::string refusal;
  ShownRegion shown;
  std::unique_ptr<Visibility> visibility;  // of the mesh as it is, once the brush has asked
  Preparation preparation = Preparation::None;
  DragFigures heard;  // times and errors, from the worker
  SolverPose solved;
  SolverThread worker;  // last: its thread ends first

  Impl(TriangleMesh mesh, StoredScalar stored, Callbacks given)
      : callbacks(std::move(given)),
        scalar(stored),
        history(checked(std::move(mesh))),
        adjacency(std::make_shared<const Adjacency>(
            build_adjacency(static_cast<int>(original().vertices.rows()), original().faces))),
        settings(settings_for(original())),
        worker(callbacks.wake) {}

  const TriangleMesh& original() const { return history.original(); }
  const TriangleMesh& mesh() const { return *history.mesh(); }
  const std::vector<std::vector<int>>& groups() const { return selection.groups; }
  Surface surface() const {
    return {mesh(), *adjacency, settings, shown.region().get(), preparation == Preparation::Done};
  }
  Vector3 center() const { return centroid(mesh().vertices, groups()[selection.active]); }

  // Phases.
  template <class P>
  P* in() {
    return std::get_if<P>(&phase);
  }
  Drag* drag();
  MouseEvents* waiting();
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
  void change_region(Choice (*choose)(const Surface&, const Selection&));
  void press_surface(const SurfaceHit& hit, const Cursor& cursor, PressModifiers modifiers);
  void click(const Press& press);
  void brush(const Cursor& cursor);
  void prepare();

  // Motion.
  bool begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button);
  bool begin_by_key(MotionKind kind, const Cursor& cursor);
  bool motion_key(DragKey key, const Cursor& cursor);
  void ask();
  void release_motion();

  // Steps.
  void amend();
  MouseEvents commit_release();
  MouseEvents commit_amended();
  MouseEvents commit_loaded(const std::vector<EditResult>& results);
  void go_on();
  void take_over(const AppliedStep& step, bool applied);

  // News of the worker.
  MouseEvents take_pose();
  void on_error(const std::string& sentence);
};

// --- Phases ---------------------------------------------------------------------------------------------------------

Drag* DragSession::Impl::drag() {
  if (Dragging* const dragging = in<Dragging>()) {
    return &dragging->drag;
  }
  Releasing* const releasing = in<Releasing>();
  return releasing ? &releasing->drag : nullptr;
}

/// The events that wait for the worker, null if nothing has to wait for it.
MouseEvents* DragSession::Impl::waiting() {
  if (Releasing* const releasing = in<Releasing>()) {
    return &releasing->waiting;
  }
  if (Amending* const amending = in<Amending>()) {
    return &amending->waiting;
  }
  Loading* const loading = in<Loading>();
  return loading ? &loading->waiting : nullptr;
}

/// Whether settings are about the last step.
bool DragSession::Impl::amendable() {
  const Picked* const picked = in<Picked>();
  return (picked && picked->amendable) || in<Amending>();
}

void DragSession::Impl::rest(bool amendable) {
  if (groups().empty()) {
    phase = Idle();
  } else {
    phase = Picked{amendable};
  }
}

/// Ends what is in progress without a trace.
void DragSession::Impl::drop() {
  pressed.reset();
  const Loading* const loading = in<Loading>();
  const bool elsewhere = loading || in<Amending>();  // what the worker has prepared is not the selection
  rest(loading ? loading->amendable : amendable());
  if (std::shared_ptr<const Region> awaited = shown.take_awaited()) {
    back_to_mesh(true);
    show_region(std::move(awaited));
  }
  back_to_mesh(true);
  if (elsewhere) {
    prepare();
  }
}

/// Whether region and handles may change now; ends a drag in progress for it.
bool DragSession::Impl::settle_down() {
  if (waiting()) {
    refusal = messages::kStillSettling;
    return false;
  }
  if (drag()) {
    drop();
  }
  end_stroke();
  return true;
}

/// Ends a stroke of the brush that something else cuts short.
void DragSession::Impl::end_stroke() {
  const bool brushed = pressed && pressed->brushed;
  pressed.reset();
  if (brushed) {
    handles_changed();
  }
}

// --- What is seen ---------------------------------------------------------------------------------------------------

/// After a change of the mesh.
void DragSession::Impl::show_mesh(const std::vector<int>& vertices, const Points& places, bool settled) {
  visibility.reset();
  show(vertices, places, settled);
}

/// Shows a region that was made by hand before its distances are known.
void DragSession::Impl::show_by_hand() {
  show_region(std::make_shared<const Region>(region_by_hand(mesh(), *adjacency, selection.region.vertices, groups())));
}

void DragSession::Impl::back_to_mesh(bool settled) {
  if (shown.rest(mesh())) {
    show(shown.region()->mesh_vertex, shown.pose(), settled);
  }
}

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
bool DragSession::ready() const {
  return impl_->preparation == Impl::Preparation::Done;
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
  if (s.in<Idle>()) {
    return s.selection.has_region ? messages::kPickInRegion : messages::kPickAnywhere;
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
  const bool new_rest = settings.padding != s.settings.padding || !same(settings.edit, s.settings.edit);
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
    s.selection = with_radius(s.selection, settings);
    if (Picked* const picked = s.in<Picked>()) {
      picked->amendable = false;
    }
  } else if (!new_rest) {
    return;
  }
  s.selection = with_padding(std::move(s.selection), settings.padding);
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

// --- Mouse ----------------------------------------------------------------------------------------------------------

void DragSession::press(const Cursor& cursor, PressModifiers modifiers) {
  Impl& s = *impl_;
  if (!cursor.view.valid()) {
    return;
  }
  if (MouseEvents* const waiting = s.waiting()) {
    waiting->push_back({MouseEvent::Kind::Press, cursor, modifiers});
    return;
  }
  s.refusal.clear();
  if (const Drag* const drag = s.drag()) {
    if (!drag->by_button) {
      apply();
    }
    return;
  }
  const std::optional<SurfaceHit> hit = surface_at(s.mesh(), *s.adjacency, cursor);
  const bool grabs = !modifiers.add && !modifiers.take && s.selection.next != Selection::Next::Region;
  const int grabbed = grabs ? group_at(s.mesh(), s.groups(), hit, cursor, s.settings.radius) : -1;
  if (grabbed >= 0) {
    s.selection.active = grabbed;
    s.pressed = Press{hit ? hit->point : cursor.view.beside(s.center(), cursor.pixel), -1, cursor, modifiers};
  } else if (hit) {
    s.press_surface(*hit, cursor, modifiers);
  } else {
    s.refusal = messages::kNoSurface;
  }
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
    if (!s.pressed->draggable || !s.begin(MotionKind::Translate, s.pressed->point, s.pressed->cursor, true)) {
      return;
    }
  }
  Drag* const drag = s.drag();
  if (drag && (s.pressed || !drag->by_button)) {
    drag->motion.move(cursor);
    s.ask();
  }
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
  if (!press.plain() && !press.brushed) {
    s.click(press);
  }
}

// --- Region and handles ---------------------------------------------------------------------------------------------

/// Makes a choice the selection, or tells why not. @return whether it was taken
bool DragSession::Impl::take(Choice choice) {
  if (const Refusal* const refused = std::get_if<Refusal>(&choice)) {
    refusal = refused->sentence;
    return false;
  }
  Selection& chosen = std::get<Selection>(choice);
  const bool another_region = chosen.taken != selection.taken;
  selection = std::move(chosen);
  if (another_region) {
    show_region(nullptr);  // the old one would be taken for the new one's
  }
  return true;
}

/// After groups or region have changed: prepares for them.
void DragSession::Impl::handles_changed() {
  rest(false);
  prepare();
}

void DragSession::Impl::prepare() {
  if (groups().empty()) {
    preparation = Preparation::None;
    worker.cancel();
    return;
  }
  preparation = Preparation::Running;
  worker.prepare({history.mesh(), adjacency, selection.region, groups(), settings.edit, scalar});
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
  selection = brushed(surface(), selection, patch, pressed->modifiers.add);
  if (!selection.has_region) {
    show_region(nullptr);
    return;
  }
  rest(false);
  show_by_hand();
}

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
      apply();
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
  bool begun = true;
  if (key == DragKey::Rotate) {
    begun = begin_by_key(MotionKind::Rotate, cursor);
  } else if (key == DragKey::Scale) {
    begun = begin_by_key(MotionKind::Scale, cursor);
  } else if (key == DragKey::Translate || !drag()) {
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

bool DragSession::Impl::begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button) {
  if (groups().empty() || selection.active < 0 || !cursor.view.valid()) {
    return false;
  }
  const std::vector<int>& group = groups()[selection.active];
  if (kind != MotionKind::Translate && group.size() == 1) {
    refusal = messages::single_vertex(kind, group.front());
    return false;
  }
  if (preparation == Preparation::None) {
    prepare();  // it was refused before: say why again
  }
  DragMotion motion(kind, grab, center(), mean_normal(mesh(), *adjacency, group), cursor);
  if (Drag* const drag = this->drag()) {
    drag->motion = motion;  // the same gesture goes on as another kind of motion
  } else {
    phase = Dragging{{motion, by_button, {}}};
  }
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

/// Asks for the pose of the drag as it is now: a passing one or, once it is released, the one to stay.
void DragSession::Impl::ask() {
  Drag& drag = *this->drag();
  drag.maps.resize(groups().size());
  std::fill(drag.maps.begin(), drag.maps.end(), Affine::Identity());
  try {
    drag.maps[selection.active] = resolve(drag.motion.transform(), center());
  } catch (const EditError& error) {
    refusal = error.what();  // the solve that follows takes the group as not moved
  }
  drag.last_serial = worker.solve(drag.maps, in<Releasing>() != nullptr);
  drag.first_serial = std::min(drag.first_serial, drag.last_serial);
}

void DragSession::Impl::release_motion() {
  pressed.reset();
  Drag& drag = std::get<Dragging>(phase).drag;
  if (!drag.motion.moves()) {
    drop();
    return;
  }
  phase = Releasing{std::move(drag), {}};
  ask();
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

// --- Steps ----------------------------------------------------------------------------------------------------------

/// Solves the last step again with the settings as they are now.
void DragSession::Impl::amend() {
  if (!in<Amending>()) {
    phase = Amending{history.steps().back().step, history.before_last(), 0, {}};
  }
  Amending& amending = *in<Amending>();
  EditStep& step = amending.step;
  step.settings = settings.edit;
  if (step.region.padding != settings.padding) {
    step.region.anchors = KeptAnchors();
  }
  step.region.padding = settings.padding;
  if (step.region.kind == RegionSpec::Kind::Radius) {
    step.region.radius = settings.radius;
  }
  std::vector<std::vector<int>> handles;
  std::vector<Affine> maps;
  for (const HandleGroup& handle : step.handles) {
    handles.push_back(handle.vertices);
    maps.push_back(resolve(handle.transform, centroid(amending.base->vertices, handle.vertices)));
  }
  preparation = Preparation::Running;
  worker.prepare({amending.base, adjacency, step.region, std::move(handles), step.settings, scalar});
  amending.serial = worker.solve(maps, true);
}

/// @return the mouse events that waited for the step, as all functions that commit one
MouseEvents DragSession::Impl::commit_release() {
  Releasing& releasing = std::get<Releasing>(phase);
  EditStep step;
  step.region = selection.region;
  step.settings = settings.edit;
  for (const std::vector<int>& group : groups()) {
    step.handles.push_back({group, {}});
  }
  step.handles[selection.active].transform = releasing.drag.motion.transform();
  const AppliedStep& applied = history.apply(std::move(step), shown.region()->mesh_vertex, shown.pose());
  show_mesh(applied.vertices, applied.after, true);
  log(messages::step_applied(history.steps().size(), releasing.drag.motion, groups()[selection.active],
                             shown.region()->size(), heard.prepare_ms, heard.solve_ms));
  MouseEvents events = std::move(releasing.waiting);
  go_on();
  return events;
}

MouseEvents DragSession::Impl::commit_amended() {
  Amending amending = std::move(std::get<Amending>(phase));
  const std::shared_ptr<const Region> region = shown.take_awaited();
  show(history.steps().back().vertices, history.steps().back().before, false);
  const AppliedStep& applied = history.amend(amending.step, region->mesh_vertex, solved.positions);
  show_mesh(applied.vertices, applied.after, true);
  log(messages::step_amended(history.steps().size(), region->size(), heard.prepare_ms, heard.solve_ms));
  show_region(region);
  selection.region = std::move(amending.step.region);
  selection.has_region = true;
  go_on();
  return std::move(amending.waiting);
}

MouseEvents DragSession::Impl::commit_loaded(const std::vector<EditResult>& results) {
  Loading loading = std::move(std::get<Loading>(phase));
  for (std::size_t k = 0; k < results.size(); ++k) {
    const AppliedStep& applied =
        history.apply(std::move(loading.edit.steps[k]), results[k].vertices, results[k].positions);
    show_mesh(applied.vertices, applied.after, k + 1 == results.size());
  }
  log(messages::edit_applied(results.size()));
  take_over(history.steps().back(), true);
  return std::move(loading.waiting);
}

/// The next drag goes on from the mesh as it is now, in the same region.
void DragSession::Impl::go_on() {
  shown.settle();
  selection = with_region_kept(surface(), selection);
  history.set_next_region(selection.region);
  phase = Picked{true};
  prepare();
}

/// Goes back to the handle and the region of a step. @param applied  its region then is a set
void DragSession::Impl::take_over(const AppliedStep& step, bool applied) {
  selection = selection_of(step, applied, selection, settings.padding);
  shown.await(nullptr);
  if (shown.region()) {
    show_region(shown.region());
  }
  prepare();
  rest(applied);
}

bool DragSession::can_undo() const {
  return impl_->history.can_undo() || impl_->in_progress();
}

bool DragSession::can_redo() const {
  return impl_->history.can_redo() && !impl_->in_progress();
}

void DragSession::undo() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.in_progress()) {
    s.drop();
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
  if (!s.settle_down()) {
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

void DragSession::Impl::on_error(const std::string& sentence) {
  preparation = Preparation::None;
  log(messages::not_possible(sentence));
  if (in_progress()) {
    drop();
  }
  if (!shown.region() || !selection.has_region) {
    show_region(nullptr);
  }
  refusal = sentence;
}

/// @return the mouse events that waited for the step, if the pose completes one
MouseEvents DragSession::Impl::take_pose() {
  if (const Amending* const amending = in<Amending>()) {
    if (solved.serial != amending->serial) {
      return {};
    }
    heard.solve_ms = solved.solve_ms;
    return commit_amended();
  }
  const Drag* const drag = this->drag();
  if (!drag || solved.serial < drag->first_serial) {
    return {};
  }
  heard.solve_ms = solved.solve_ms;
  if (std::shared_ptr<const Region> awaited = shown.take_awaited()) {
    back_to_mesh(false);
    show_region(std::move(awaited));
  }
  const bool released = in<Releasing>() != nullptr;
  if (!shown.region() || solved.positions.rows() != shown.region()->size()) {
    if (released) {
      drop();
    }
    return {};
  }
  shown.pose(solved.positions);
  if (released && solved.serial == drag->last_serial) {
    return commit_release();
  }
  show(shown.region()->mesh_vertex, shown.pose(), false);
  return {};
}

bool DragSession::poll() {
  Impl& s = *impl_;
  const SolverNews news = s.worker.poll(s.solved);
  MouseEvents events;
  if (news.region) {
    if (s.shown.away() || s.in<Amending>() || s.in<Loading>()) {
      s.shown.await(news.region);
    } else {
      s.show_region(news.region);
    }
  }
  if (news.ready) {
    s.preparation = Impl::Preparation::Done;
    s.heard.prepare_ms = news.prepare_ms;
  }
  if (news.report) {
    s.heard.handle_error = news.report->handle_residual;
    s.heard.largest_stretch = news.report->stretch_max;
  }
  if (news.pose) {
    events = s.take_pose();
  }
  if (news.applied) {
    events = s.commit_loaded(*news.applied);
  }
  if (!news.error.empty()) {
    s.on_error(news.error);
  }
  if (!news.pose_error.empty()) {
    if (s.waiting()) {
      s.log(messages::not_possible(news.pose_error));
      s.drop();
    }
    s.refusal = news.pose_error;
  }
  for (const MouseEvent& event : events) {
    if (event.kind == MouseEvent::Kind::Press) {
      press(event.cursor, event.modifiers);
    } else if (event.kind == MouseEvent::Kind::Move) {
      move(event.cursor);
    } else {
      release(event.cursor);
    }
  }
  return news.region || news.ready || news.report || news.pose || news.applied || !news.error.empty() ||
         !news.pose_error.empty();
}

void DragSession::finish() {
  Impl& s = *impl_;
  s.pressed.reset();
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
