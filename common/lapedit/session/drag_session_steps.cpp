// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/session/drag_session_impl.h"

namespace lapedit {
namespace {

Points gather(const Points& points, const std::vector<int>& vertices) {
  Points rows(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = points.row(vertices[i]);
  }
  return rows;
}

/// Area-weighted normal of the surface at some vertices; zero if there is none.
Vector3 mean_normal(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices) {
  Vector3 sum = Vector3::Zero();
  for (const int v : vertices) {
    for (const int f : adjacency.faces[v]) {
      const Vector3 a = mesh.vertices.row(mesh.faces(f, 0)).transpose();
      const Vector3 b = mesh.vertices.row(mesh.faces(f, 1)).transpose();
      const Vector3 c = mesh.vertices.row(mesh.faces(f, 2)).transpose();
      const Vector3 normal = (b - a).cross(c - a);
      if (normal.allFinite()) {
        sum += normal;
      }
    }
  }
  return sum;
}

const char* ending(std::size_t count) {
  return count == 1 ? "" : "s";
}

}  // namespace

// --- Mesh and poses -------------------------------------------------------------------------------------------------

void DragSession::Impl::write(const std::vector<int>& vertices, const Points& places) {
  // A new one, since the worker may be reading the old one; some milliseconds for a large mesh, and never while
  // dragging.
  auto changed = std::make_shared<TriangleMesh>(*current);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    changed->vertices.row(vertices[i]) = places.row(static_cast<Eigen::Index>(i));
  }
  current = std::move(changed);
  visibility.reset();
}

void DragSession::Impl::show_region(std::shared_ptr<const Region> shown) {
  region = std::move(shown);
  if (region) {
    pose = gather(current->vertices, region->mesh_vertex);
  }
  away = false;
  ++pose_serial;
}

void DragSession::Impl::back_to_rest(bool settled) {
  if (away && region) {
    pose = gather(current->vertices, region->mesh_vertex);
    show(region->mesh_vertex, pose, settled);
    away = false;
    ++pose_serial;
  }
}

// --- Motion ---------------------------------------------------------------------------------------------------------

bool DragSession::Impl::begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button) {
  if (groups.empty() || active < 0 || !cursor.view.valid()) {
    return false;
  }
  const std::vector<int>& group = groups[active];
  if (kind != MotionKind::Translate && group.size() == 1) {
    refuse(format_text(
        "%s needs a handle of several vertices, and this one is vertex %d alone: set a handle radius or add "
        "vertices with Ctrl-clicks.",
        kind == MotionKind::Rotate ? "Turning" : "Scaling", group.front()));
    return false;
  }
  if (!ready && !preparing) {
    prepare();  // it was refused before: say why again
  }
  motion.emplace(kind, grab, centroid(current->vertices, group), mean_normal(*current, *adjacency, group), cursor);
  held = by_button;
  state = State::Dragging;
  amendable = false;
  return true;
}

bool DragSession::Impl::begin_by_key(MotionKind kind, const Cursor& cursor) {
  if (pressed && (pressed->modifiers.add || pressed->modifiers.take)) {
    end_stroke();
  }
  if (groups.empty() || active < 0 || !cursor.view.valid()) {
    return false;
  }
  if (motion) {
    // The same gesture goes on as another kind of motion.
    const bool by_button = held;
    const Vector3 grab = motion->grab();
    return begin(kind, grab, cursor, by_button);
  }
  return begin(kind, centroid(current->vertices, groups[active]), cursor, false);
}

void DragSession::Impl::ask(bool last) {
  maps.resize(groups.size());
  std::fill(maps.begin(), maps.end(), Affine::Identity());
  try {
    maps[active] = resolve(motion->transform(), centroid(current->vertices, groups[active]));
  } catch (const EditError& error) {
    refuse(error.what());  // the solve that follows takes the group as not moved
  }
  last_serial = worker.solve(maps, last);
  first_serial = std::min(first_serial, last_serial);
}

/// Ends a drag without a trace.
void DragSession::Impl::drop() {
  motion.reset();
  pressed.reset();
  deferred.clear();
  const bool was_amending = state == State::Settling && settling != Settling::Release;
  state = groups.empty() ? State::Idle : State::Picked;
  first_serial = last_serial = kNone;  // poses on their way are of no interest
  if (incoming) {
    back_to_rest(true);
    show_region(std::exchange(incoming, nullptr));
  }
  back_to_rest(true);
  if (was_amending) {
    amend_base.reset();
    prepare();
  }
}

void DragSession::Impl::release_motion() {
  pressed.reset();
  if (!motion->moves()) {
    drop();
    return;
  }
  state = State::Settling;
  settling = Settling::Release;
  ask(true);
}

// --- Steps ----------------------------------------------------------------------------------------------------------

EditStep DragSession::Impl::step_now() const {
  EditStep step;
  step.region = spec;
  step.settings = settings.edit;
  step.handles.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    step.handles[g].vertices = groups[g];
  }
  if (motion) {
    step.handles[active].transform = motion->transform();
  }
  return step;
}

/// The next drag goes on from the mesh as it is now, in the same region.
void DragSession::Impl::after_commit() {
  undone.clear();
  amendable = true;
  motion.reset();
  first_serial = last_serial = kNone;
  state = State::Picked;
  away = false;
  ++pose_serial;
  keep_region();
  steps.back().next = spec;
  prepare();
}

void DragSession::Impl::commit_release() {
  AppliedStep applied;
  applied.step = step_now();
  applied.vertices = region->mesh_vertex;
  applied.before = gather(current->vertices, applied.vertices);
  applied.after = pose;
  write(applied.vertices, applied.after);
  show(applied.vertices, applied.after, true);
  const std::vector<int>& handle = groups[active];
  log(format_text(
      "step %zu: %s, handle of %zu vert%s (%s%d), region of %d vertices, prepared in %.1f ms, solved in %.1f ms",
      steps.size() + 1, motion->text().c_str(), handle.size(), handle.size() == 1 ? "ex" : "ices",
      handle.size() == 1 ? "" : "the first is ", handle.front(), region->size(), prepare_ms, solve_ms));
  steps.push_back(std::move(applied));
  after_commit();
}

/// Solves the last step again with the settings as they are now.
void DragSession::Impl::amend() {
  const AppliedStep& last = steps.back();
  if (state != State::Settling) {
    amended = last.step;
    auto base = std::make_shared<TriangleMesh>(*current);
    for (std::size_t i = 0; i < last.vertices.size(); ++i) {
      base->vertices.row(last.vertices[i]) = last.before.row(static_cast<Eigen::Index>(i));
    }
    amend_base = base;
  }
  amended.settings = settings.edit;
  if (amended.region.padding != settings.padding) {
    amended.region.anchors = KeptAnchors();
  }
  amended.region.padding = settings.padding;
  if (amended.region.kind == RegionSpec::Kind::Radius) {
    amended.region.radius = settings.radius;
  }
  state = State::Settling;
  settling = Settling::Amend;
  ready = false;
  preparing = true;
  std::vector<std::vector<int>> amended_groups;
  maps.clear();
  for (const HandleGroup& handle : amended.handles) {
    amended_groups.push_back(handle.vertices);
    maps.push_back(resolve(handle.transform, centroid(amend_base->vertices, handle.vertices)));
  }
  worker.prepare({amend_base, adjacency, amended.region, amended_groups, amended.settings, scalar});
  first_serial = last_serial = worker.solve(maps, true);
}

void DragSession::Impl::commit_amended() {
  AppliedStep& last = steps.back();
  const std::shared_ptr<const Region> solved = std::exchange(incoming, nullptr);
  const std::vector<int> old_vertices = std::move(last.vertices);
  const Points old_before = std::move(last.before);
  write(old_vertices, old_before);
  show(old_vertices, old_before, false);
  last.step = amended;
  last.vertices = solved->mesh_vertex;
  last.before = gather(current->vertices, last.vertices);
  last.after = worker_pose.positions;
  write(last.vertices, last.after);
  show(last.vertices, last.after, true);
  amend_base.reset();
  log(format_text("step %zu again with other settings: region of %d vertices, prepared in %.1f ms, solved in %.1f ms",
                  steps.size(), solved->size(), prepare_ms, solve_ms));
  show_region(solved);
  spec = amended.region;
  has_region = true;
  after_commit();
}

void DragSession::Impl::commit_loaded(const std::vector<EditResult>& results) {
  for (std::size_t k = 0; k < results.size(); ++k) {
    AppliedStep applied;
    applied.step = loading.steps[k];
    applied.vertices = results[k].vertices;
    applied.before = gather(current->vertices, applied.vertices);
    applied.after = results[k].positions;
    write(applied.vertices, applied.after);
    show(applied.vertices, applied.after, k + 1 == results.size());
    steps.push_back(std::move(applied));
  }
  log(format_text("%zu step%s of a saved edit applied", results.size(), ending(results.size())));
  undone.clear();
  loading = Edit();
  take_over(steps.back(), true);
}

/// Goes back to the handle and the region of a step. @param done  whether it is applied: its region then is a set
void DragSession::Impl::take_over(const AppliedStep& step, bool done) {
  groups.clear();
  active = 0;
  for (const HandleGroup& handle : step.step.handles) {
    if (!resolve(handle.transform, Vector3::Zero()).matrix().isIdentity(0)) {
      active = static_cast<int>(groups.size());
    }
    groups.push_back(handle.vertices);
  }
  spec = done && step.next.kind == RegionSpec::Kind::Vertices ? step.next : step.step.region;
  if (done && spec.kind == RegionSpec::Kind::Radius) {
    set_vertices(step.vertices);
  }
  sync_padding();
  has_region = true;
  by_hand = want_group = want_region = false;
  curve_end = -1;
  incoming.reset();
  if (region) {
    show_region(region);
  }
  handles_changed();
  amendable = done;
}

void DragSession::Impl::undo_one(bool settled) {
  AppliedStep step = std::move(steps.back());
  steps.pop_back();
  write(step.vertices, step.before);
  show(step.vertices, step.before, settled);
  undone.push_back(std::move(step));
}

void DragSession::Impl::redo_one() {
  AppliedStep step = std::move(undone.back());
  undone.pop_back();
  write(step.vertices, step.after);
  show(step.vertices, step.after, true);
  steps.push_back(std::move(step));
}

bool DragSession::can_undo() const {
  return !impl_->steps.empty() || impl_->motion || impl_->state == State::Settling;
}

bool DragSession::can_redo() const {
  return !impl_->undone.empty() && !impl_->motion && impl_->state != State::Settling;
}

void DragSession::undo() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.motion || s.state == State::Settling) {
    s.drop();
    return;
  }
  if (s.steps.empty()) {
    s.refuse("There is nothing to undo: no step has been applied.");
    return;
  }
  s.undo_one(true);
  s.log(format_text("step %zu undone", s.steps.size() + 1));
  s.take_over(s.undone.back(), false);
}

void DragSession::redo() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (!s.at_rest()) {
    return;
  }
  if (s.undone.empty()) {
    s.refuse("There is nothing to redo: no step has been undone.");
    return;
  }
  s.redo_one();
  s.log(format_text("step %zu redone", s.steps.size()));
  s.take_over(s.steps.back(), true);
}

void DragSession::reset() {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.motion || s.state == State::Settling) {
    s.drop();
  }
  if (s.steps.empty()) {
    return;
  }
  const std::size_t count = s.steps.size();
  while (!s.steps.empty()) {
    s.undo_one(s.steps.size() == 1);
  }
  s.log(format_text("back to the original: %zu step%s undone", count, ending(count)));
  s.take_over(s.undone.back(), false);
}

Edit DragSession::recorded() const {
  const Impl& s = *impl_;
  Edit edit;
  edit.mesh_vertices = static_cast<int>(s.original->vertices.rows());
  edit.mesh_faces = static_cast<int>(s.original->faces.rows());
  if (s.checksum.empty()) {
    s.checksum = connectivity_checksum(static_cast<std::size_t>(s.original->vertices.rows()), s.original->faces);
  }
  edit.connectivity = s.checksum;
  for (const AppliedStep& applied : s.steps) {
    edit.steps.push_back(applied.step);
  }
  return edit;
}

void DragSession::load(Edit edit) {
  Impl& s = *impl_;
  s.refusal.clear();
  if (s.motion || s.state == State::Settling) {
    s.drop();
  }
  s.pressed.reset();
  s.preparing = true;
  s.ready = false;
  s.state = State::Settling;
  s.settling = Impl::Settling::Load;
  s.loading = std::move(edit);
  s.worker.apply({s.current, s.adjacency, s.loading, s.scalar});
}

}  // namespace lapedit
