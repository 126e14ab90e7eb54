// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_session.h"

#include <cmath>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/session/drag_session_impl.h"

namespace lapedit {
namespace {

constexpr double kRadiusOfDiagonal = 0.1;

double finite_diagonal(const Points& points) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (points.row(i).allFinite()) {
      box.extend(Vector3(points.row(i).transpose()));
    }
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

bool same(const EditSettings& a, const EditSettings& b) {
  return a.laplacian == b.laplacian && a.order == b.order && a.rotation == b.rotation && a.iterations == b.iterations &&
         a.normal_radius == b.normal_radius && a.handle_weight == b.handle_weight &&
         a.anchor_weight == b.anchor_weight && a.backend == b.backend && a.threads == b.threads;
}

void check(const DragSettings& settings) {
  validate(settings.edit);
  const auto refuse = [](const char* what, double value, const char* wanted) {
    throw EditError(ErrorCause::BadParameter, format_text("The %s is %g: give %s.", what, value, wanted));
  };
  if (!(settings.radius > 0 && std::isfinite(settings.radius))) {
    refuse("region's radius", settings.radius, "a finite length greater than 0");
  }
  if (!(settings.padding >= 0 && settings.padding <= 1)) {
    refuse("padding", settings.padding, "a share of the region's radius from 0 to 1");
  }
  if (!(settings.handle_radius >= 0 && std::isfinite(settings.handle_radius))) {
    refuse("handle's radius", settings.handle_radius, "a finite length, or 0 for a single vertex");
  }
  if (!(settings.brush_pixels >= 1 && settings.brush_pixels <= 1000)) {
    refuse("brush's radius", settings.brush_pixels, "1 to 1000 pixels");
  }
}

}  // namespace

DragSession::Impl::Impl(TriangleMesh mesh, StoredScalar stored, Callbacks given)
    : callbacks(std::move(given)), scalar(stored), worker(callbacks.wake) {
  validate(mesh);
  adjacency = std::make_shared<const Adjacency>(build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces));
  current = std::make_shared<const TriangleMesh>(std::move(mesh));
  original = current;
  const double diagonal = finite_diagonal(current->vertices);
  settings.radius = diagonal > 0 ? kRadiusOfDiagonal * diagonal : 1;
}

/// Whether region and handles may change now; ends a drag in progress for it.
bool DragSession::Impl::at_rest() {
  if (state == State::Settling) {
    refuse("The last step is still being worked out: wait a moment, or press Backspace to drop it.");
    return false;
  }
  if (motion) {
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

DragSession::DragSession(TriangleMesh mesh, StoredScalar scalar, Callbacks callbacks)
    : impl_(std::make_unique<Impl>(std::move(mesh), scalar, std::move(callbacks))) {}
DragSession::~DragSession() = default;

// --- What there is to see -------------------------------------------------------------------------------------------

DragSession::State DragSession::state() const {
  return impl_->state;
}
const TriangleMesh& DragSession::original() const {
  return *impl_->original;
}
const TriangleMesh& DragSession::mesh() const {
  return *impl_->current;
}
const Adjacency& DragSession::adjacency() const {
  return *impl_->adjacency;
}
const Region* DragSession::region() const {
  return impl_->region.get();
}
const Points& DragSession::pose() const {
  return impl_->pose;
}
int DragSession::pose_serial() const {
  return impl_->pose_serial;
}
const std::vector<std::vector<int>>& DragSession::groups() const {
  return impl_->groups;
}
int DragSession::active_group() const {
  return impl_->active;
}
const DragMotion* DragSession::motion() const {
  return impl_->motion ? &*impl_->motion : nullptr;
}
bool DragSession::preparing() const {
  return impl_->preparing;
}
double DragSession::progress() const {
  return impl_->worker.progress();
}
const char* DragSession::stage() const {
  return impl_->worker.stage();
}
bool DragSession::ready() const {
  return impl_->ready;
}
bool DragSession::busy() const {
  return impl_->worker.busy();
}
const DragSettings& DragSession::settings() const {
  return impl_->settings;
}
HandleMode DragSession::handle_mode() const {
  return impl_->mode;
}

Affine DragSession::active_map() const {
  const Impl& s = *impl_;
  if (!s.motion || s.active < 0) {
    return Affine::Identity();
  }
  return resolve(s.motion->transform(), centroid(s.current->vertices, s.groups[s.active]));
}

std::string DragSession::message() const {
  const Impl& s = *impl_;
  if (!s.refusal.empty()) {
    return s.refusal;
  }
  if (s.state == State::Settling) {
    return s.settling == Impl::Settling::Load ? "Applying the saved edit. Backspace drops it."
                                              : "Solving for the exact result. Backspace drops it.";
  }
  if (s.motion) {
    return s.motion->text() + (s.held ? ": release to apply" : ": click or press Return to apply") +
           ", Backspace drops it; X Y Z N lock an axis, digits give an amount.";
  }
  if (s.want_region) {
    return "Click on the surface for a new region and its handle.";
  }
  if (s.want_group) {
    return "Click on the surface for another handle; those there hold their place.";
  }
  if (s.state == State::Idle) {
    return s.has_region ? "Click inside the region to pick its handle."
                        : "Press on the surface and drag, or click to see the region first.";
  }
  if (s.mode == HandleMode::Curve && s.curve_end >= 0) {
    return "Click to lead the curve on, drag the curve to move it; C ends it.";
  }
  return "Drag the handle (R turns, S scales, T moves it), click inside the region for another one, outside for a new "
         "region.";
}

DragFigures DragSession::figures() const {
  const Impl& s = *impl_;
  DragFigures figures;
  if (s.region) {
    figures.handle = s.region->count(VertexClass::Handle);
    figures.free = s.region->count(VertexClass::Free);
    figures.anchors = s.region->count(VertexClass::Anchor);
    figures.fixed = static_cast<int>(s.current->vertices.rows()) - s.region->size();
  }
  figures.prepare_ms = s.prepare_ms;
  figures.solve_ms = s.solve_ms;
  if (s.report) {
    figures.handle_error = s.report->handle_residual;
    figures.largest_stretch = s.report->stretch_max;
  }
  figures.steps = static_cast<int>(s.steps.size());
  return figures;
}

// --- Settings -------------------------------------------------------------------------------------------------------

void DragSession::set_settings(const DragSettings& settings) {
  Impl& s = *impl_;
  s.refusal.clear();
  try {
    check(settings);
  } catch (const EditError& error) {
    s.refuse(error.what());
    return;
  }
  const bool new_radius = settings.radius != s.settings.radius;
  const bool new_rest = settings.padding != s.settings.padding || !same(settings.edit, s.settings.edit);
  s.settings = settings;
  if (s.state == State::Settling && s.settling == Impl::Settling::Load) {
    return;
  }
  if (s.amendable && !s.steps.empty() &&
      (new_rest || (new_radius && s.steps.back().step.region.kind == RegionSpec::Kind::Radius))) {
    s.amend();
    return;
  }
  // The radius counts for regions that were grown by it, and for what is left of them after a step.
  const bool regrow = new_radius && s.has_region && !s.by_hand && s.spec.kind != RegionSpec::Kind::Component;
  if (regrow) {
    s.set_radius();
    s.amendable = false;
  } else if (!new_rest) {
    return;
  }
  s.sync_padding();
  if (s.groups.empty()) {
    return;
  }
  s.prepare();
  if (s.motion) {
    s.ask(s.state == State::Settling);
  }
}

void DragSession::set_handle_mode(HandleMode mode) {
  impl_->refusal.clear();
  impl_->mode = mode;
  impl_->curve_end = -1;
}

// --- Mouse ----------------------------------------------------------------------------------------------------------

void DragSession::press(const Cursor& cursor, PressModifiers modifiers) {
  Impl& s = *impl_;
  if (!cursor.view.valid()) {
    return;
  }
  if (s.state == State::Settling) {
    s.deferred.push_back({Impl::Deferred::Press, cursor, modifiers});
    return;
  }
  s.refusal.clear();
  if (s.motion) {
    if (!s.held) {
      apply();
    }
    return;
  }
  const std::optional<SurfaceHit> hit = s.hit_at(cursor);
  const bool plain = !modifiers.add && !modifiers.take;
  const int grabbed = plain ? s.group_at(hit, cursor) : -1;
  if (!hit && grabbed < 0) {
    s.refuse("There is no surface of this layer under the cursor: click on the mesh.");
    return;
  }
  if (grabbed >= 0) {
    s.active = grabbed;
    s.state = State::Picked;
    const Vector3 handle = centroid(s.current->vertices, s.groups[grabbed]);
    s.pressed = Impl::Press{hit ? hit->point : cursor.view.beside(handle, cursor.pixel), -1, cursor, modifiers};
    return;
  }
  s.pressed = Impl::Press{hit->point, hit->vertex, cursor, modifiers};
  if (!plain) {
    return;
  }
  try {
    s.pick(*hit);
  } catch (const EditError& error) {
    s.pressed.reset();
    s.refuse(error.what());
  }
}

void DragSession::move(const Cursor& cursor) {
  Impl& s = *impl_;
  if (!cursor.view.valid()) {
    return;
  }
  if (s.state == State::Settling) {
    if (!s.deferred.empty()) {
      if (s.deferred.back().kind == Impl::Deferred::Move) {
        s.deferred.pop_back();
      }
      s.deferred.push_back({Impl::Deferred::Move, cursor, {}});
    }
    return;
  }
  if (s.pressed && (s.pressed->modifiers.add || s.pressed->modifiers.take)) {
    if (!s.pressed->brushed) {
      s.pressed->brushed = true;
      s.brush(s.pressed->cursor);
    }
    s.brush(cursor);
    return;
  }
  if (s.pressed && !s.motion) {
    // The motion begins where the button went down, however far the first move already is.
    if (!s.pressed->draggable || !s.begin(MotionKind::Translate, s.pressed->point, s.pressed->cursor, true)) {
      return;
    }
  }
  if (s.motion && (s.pressed || !s.held)) {
    s.motion->move(cursor);
    s.ask(false);
  }
}

void DragSession::release(const Cursor& cursor) {
  Impl& s = *impl_;
  if (s.state == State::Settling) {
    if (!s.deferred.empty()) {
      s.deferred.push_back({Impl::Deferred::Release, cursor, {}});
    }
    return;
  }
  if (!s.pressed) {
    return;
  }
  const Impl::Press press = *s.pressed;
  if (s.motion) {
    if (cursor.view.valid()) {
      s.motion->move(cursor);
    }
    s.release_motion();
    return;
  }
  s.end_stroke();
  if (press.brushed) {
    return;
  }
  try {
    if (press.modifiers.add) {
      s.add_to_handle(press.vertex);
    } else if (press.modifiers.take) {
      s.take_from_handle(press.vertex);
    }
  } catch (const EditError& error) {
    s.refuse(error.what());
  }
}

// --- Keys -----------------------------------------------------------------------------------------------------------

bool DragSession::key(char key, const Cursor& cursor) {
  Impl& s = *impl_;
  s.refusal.clear();
  if (key == '\b') {
    const bool something = s.motion || s.state == State::Settling;
    cancel();
    return something;
  }
  if (s.state == State::Settling) {
    return false;
  }
  switch (key) {
    case '\r':
      apply();
      return true;
    case 'g':
      next_group();
      return true;
    case 'w':
      new_region();
      return true;
    case 'c':
      set_handle_mode(s.mode == HandleMode::Curve ? HandleMode::Vertex : HandleMode::Curve);
      return true;
    case 't':
      return s.begin_by_key(MotionKind::Translate, cursor) && (s.ask(false), true);
    case 'r':
      return s.begin_by_key(MotionKind::Rotate, cursor) && (s.ask(false), true);
    case 's':
      return s.begin_by_key(MotionKind::Scale, cursor) && (s.ask(false), true);
    default:
      break;
  }
  const std::string axes = "xyzn";
  const std::size_t axis = axes.find(key);
  const bool amount = (key >= '0' && key <= '9') || key == '.' || key == '-';
  if (axis == std::string::npos && !amount) {
    return false;
  }
  if (!s.motion && !s.begin_by_key(MotionKind::Translate, cursor)) {
    return false;
  }
  constexpr AxisLock kLocks[] = {AxisLock::X, AxisLock::Y, AxisLock::Z, AxisLock::Normal};
  if (amount) {
    s.motion->type(key);
  } else if (!s.motion->toggle_lock(kLocks[axis])) {
    s.refuse("The surface has no normal at the handle: lock X, Y or Z instead.");
  }
  s.ask(false);
  return true;
}

void DragSession::apply() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.motion && s.state == State::Dragging) {
    s.release_motion();
  }
}

void DragSession::cancel() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.motion || s.state == State::Settling) {
    s.drop();
  }
}

// --- Worker ---------------------------------------------------------------------------------------------------------

void DragSession::Impl::on_error(const std::string& sentence) {
  preparing = false;
  ready = false;
  log("not possible: " + sentence);
  if (motion || state == State::Settling) {
    drop();
  }
  if (!region || !has_region) {
    show_region(nullptr);
  }
  refuse(sentence);
}

void DragSession::Impl::take_pose() {
  if (worker_pose.serial < first_serial || (state != State::Dragging && state != State::Settling)) {
    return;
  }
  solve_ms = worker_pose.solve_ms;
  const bool last = state == State::Settling && worker_pose.serial == last_serial;
  if (state == State::Settling && settling == Settling::Amend) {
    if (last) {
      commit_amended();
    }
    return;
  }
  if (incoming) {
    back_to_rest(false);
    show_region(std::exchange(incoming, nullptr));
  }
  if (!region || worker_pose.positions.rows() != region->size()) {
    if (state == State::Settling) {
      drop();
    }
    return;
  }
  pose.swap(worker_pose.positions);
  ++pose_serial;
  away = true;
  if (last) {
    commit_release();
  } else {
    show(region->mesh_vertex, pose, false);
  }
}

bool DragSession::poll() {
  Impl& s = *impl_;
  const SolverNews news = s.worker.poll(s.worker_pose);
  if (news.region) {
    if (s.away || (s.state == State::Settling && s.settling != Impl::Settling::Release)) {
      s.incoming = news.region;  // shown with its first pose
    } else {
      s.show_region(news.region);
    }
  }
  if (news.ready) {
    s.preparing = false;
    s.ready = true;
    s.prepare_ms = news.prepare_ms;
  }
  if (news.report) {
    s.report = news.report;
  }
  if (news.pose) {
    s.take_pose();
  }
  if (news.applied) {
    s.commit_loaded(*news.applied);
  }
  if (!news.error.empty()) {
    s.on_error(news.error);
  }
  if (!news.pose_error.empty()) {
    if (s.state == State::Settling) {
      s.log("not possible: " + news.pose_error);
      s.drop();
    }
    s.refuse(news.pose_error);
  }
  if (s.state != State::Settling && !s.deferred.empty()) {
    for (const Impl::Deferred& event : std::exchange(s.deferred, {})) {
      if (event.kind == Impl::Deferred::Press) {
        press(event.cursor, event.modifiers);
      } else if (event.kind == Impl::Deferred::Move) {
        move(event.cursor);
      } else {
        release(event.cursor);
      }
    }
  }
  return news.region || news.ready || news.report || news.pose || news.applied || !news.error.empty() ||
         !news.pose_error.empty();
}

void DragSession::finish() {
  Impl& s = *impl_;
  s.deferred.clear();
  s.pressed.reset();
  while (s.state == State::Settling && s.settling == Impl::Settling::Release && s.worker.wait()) {
    poll();
  }
  if (s.motion || s.state == State::Settling) {
    s.drop();
  }
}

void DragSession::wait() {
  while (impl_->worker.wait()) {
    poll();
  }
}

}  // namespace lapedit
