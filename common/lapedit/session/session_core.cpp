// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/session_core.h"

#include <algorithm>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"
#include "lapedit/session/picking.h"

namespace lapedit {

using namespace phase;

namespace {

TriangleMesh checked(TriangleMesh mesh) {
  validate(mesh);
  return mesh;
}

}  // namespace

SessionCore::SessionCore(TriangleMesh mesh, StoredScalar stored, DragSession::Callbacks given)
    : callbacks(std::move(given)),
      scalar(stored),
      history(checked(std::move(mesh))),
      adjacency(std::make_shared<const Adjacency>(
          build_adjacency(static_cast<int>(original().vertices.rows()), original().faces))),
      settings(settings_for(original())),
      pointer(callbacks.wake),
      worker(callbacks.wake) {}

// --- Phases ----------------------------------------------------------------------------------------------------------

Drag* SessionCore::drag() {
  if (Dragging* const dragging = in<Dragging>()) {
    return &dragging->drag;
  }
  Releasing* const releasing = in<Releasing>();
  return releasing ? &releasing->drag : nullptr;
}

/// The events that wait for the worker, null if nothing has to wait for it.
MouseEvents* SessionCore::waiting() {
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
bool SessionCore::amendable() {
  const Picked* const picked = in<Picked>();
  return (picked && picked->amendable) || in<Amending>();
}

void SessionCore::rest(bool amendable) {
  if (groups().empty()) {
    phase = Idle();
  } else {
    phase = Picked{amendable};
  }
}

/// Ends what is in progress without a trace.
void SessionCore::drop() {
  pressed.reset();
  pointer.part = GizmoPart::None;
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
bool SessionCore::settle_down() {
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
void SessionCore::end_stroke() {
  const bool brushed = pressed && pressed->brushed;
  pressed.reset();
  if (brushed) {
    handles_changed();
  }
}

// --- What is seen ----------------------------------------------------------------------------------------------------

/// After a change of the mesh.
void SessionCore::show_mesh(const std::vector<int>& vertices, const Points& places, bool settled) {
  visibility.reset();
  show(vertices, places, settled);
}

/// Shows a region that was made by hand before its distances are known.
void SessionCore::show_by_hand() {
  show_region(std::make_shared<const Region>(region_by_hand(mesh(), *adjacency, selection.region.vertices, groups())));
}

void SessionCore::back_to_mesh(bool settled) {
  if (shown.rest(mesh())) {
    show(shown.region()->mesh_vertex, shown.pose(), settled);
  }
}

// --- Region and handles ----------------------------------------------------------------------------------------------

/// Makes a choice the selection, or tells why not. @return whether it was taken
bool SessionCore::take(Choice choice) {
  if (const Refusal* const refused = std::get_if<Refusal>(&choice)) {
    refusal = refused->sentence;
    return false;
  }
  Selection& chosen = std::get<Selection>(choice);
  const bool another_region = chosen.taken != selection.taken;
  if (chosen.groups != selection.groups) {
    tools.mirrored.reset();  // a stroke of the brush is seen at once, its image when it is prepared for
  }
  selection = std::move(chosen);
  if (another_region) {
    show_region(nullptr);  // the old one would be taken for the new one's
  }
  return true;
}

/// After groups or region have changed: prepares for them.
void SessionCore::handles_changed() {
  heard = DragFigures();  // of another handle or region
  rest(false);
  prepare();
}

void SessionCore::prepare() {
  heard.in_hand_ms = heard.prepare_ms = std::nullopt;
  heard.taken_over.clear();
  tools.mirrored.reset();
  if (groups().empty()) {
    preparation = Preparation::None;
    in_hand = false;
    worker.cancel();
    return;
  }
  preparation = Preparation::Running;
  in_hand = false;
  PrepareTask task{history.mesh(), adjacency, selection.region,  groups(),
                   settings.edit,  scalar,    selection.weights, tools.mirror};
  if (tools.mirror) {
    try {
      tools.mirrored = std::make_unique<MirroredHandles>(mesh(), groups(), *tools.mirror, selection.weights);
      task.groups = tools.mirrored->groups();
      task.weights = tools.mirrored->weights();
      task.region = mirrored(mesh(), selection.region, *tools.mirror);
    } catch (const EditError& error) {
      worker.cancel();
      on_error(error.what());
      return;
    }
  }
  worker.prepare(std::move(task));
}

void SessionCore::restore(Selection before) {
  selection = std::move(before);
  if (selection.region.kind == RegionSpec::Kind::Vertices && selection.has_region) {
    show_by_hand();
  } else {
    show_region(nullptr);
  }
  handles_changed();
}

/// Takes the last stroke of the brush back. @return whether there was one
bool SessionCore::undo_stroke() {
  end_stroke();
  if (strokes.done.empty()) {
    return false;
  }
  strokes.undone.push_back(std::move(selection));
  Selection before = std::move(strokes.done.back());
  strokes.done.pop_back();
  restore(std::move(before));
  log(messages::kStrokeUndone);
  return true;
}

bool SessionCore::redo_stroke() {
  if (strokes.undone.empty()) {
    return false;
  }
  strokes.done.push_back(std::move(selection));
  Selection after = std::move(strokes.undone.back());
  strokes.undone.pop_back();
  restore(std::move(after));
  log(messages::kStrokeRedone);
  return true;
}

// --- Motion ----------------------------------------------------------------------------------------------------------

bool SessionCore::begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button) {
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
    if (preparation == Preparation::None) {
      return false;
    }
  }
  const bool about_pivot = kind != MotionKind::Translate && tools.pivot != Pivot::Centroid;
  DragMotion motion(kind, grab, center(), mean_normal(mesh(), *adjacency, group), cursor,
                    about_pivot ? std::optional(pivot_place()) : std::nullopt);
  if (Drag* const drag = this->drag()) {
    drag->motion = motion;  // the same gesture goes on as another kind of motion
  } else {
    phase = Dragging{{motion, by_button, {}, {}}};
  }
  return true;
}

/// Asks for the pose of the drag as it is now: a passing one or, once it is released, the one to stay.
void SessionCore::ask() {
  Drag& drag = *this->drag();
  drag.maps.assign(all_groups().size(), Affine::Identity());
  try {
    if (tools.mirrored) {
      drag.given.assign(groups().size(), HandleTransform());
      drag.given[selection.active] = drag.motion.transform();
      tools.mirrored->maps(drag.given, drag.maps);
    } else {
      drag.maps[selection.active] = resolve(drag.motion.transform(), center());
    }
  } catch (const EditError& error) {
    refusal = error.what();  // the solve that follows takes the groups as not moved
    drag.maps.assign(all_groups().size(), Affine::Identity());
  }
  drag.last_serial = worker.solve(drag.maps, in<Releasing>() != nullptr);
  drag.first_serial = std::min(drag.first_serial, drag.last_serial);
}

void SessionCore::release_motion() {
  pressed.reset();
  pointer.part = GizmoPart::None;
  Drag& drag = std::get<Dragging>(phase).drag;
  if (!drag.motion.moves()) {
    drop();
    return;
  }
  phase = Releasing{std::move(drag), {}};
  ask();
}

std::optional<Gizmo> SessionCore::gizmo(const Camera& view) const {
  const bool awaits_click = selection.next != Selection::Next::Handle || selection.mode == HandleMode::Curve ||
                            (tools.pivot == Pivot::Point && tools.pivot_vertex < 0);
  if (!tools.gizmo || awaits_click || selection.active < 0 || !view.valid()) {
    return std::nullopt;
  }
  const std::vector<int>& group = groups()[selection.active];
  return place_gizmo(pivot_place(), tools.axes, mean_normal(mesh(), *adjacency, group), view);
}

/// What turning and scaling go about.
Vector3 SessionCore::pivot_place() const {
  const Region* const region = shown.region().get();
  if (tools.pivot == Pivot::Point && tools.pivot_vertex >= 0) {
    return mesh().vertices.row(tools.pivot_vertex).transpose();
  }
  return tools.pivot == Pivot::Rim && region ? middle_of_rim(mesh(), *region, groups()[selection.active]) : center();
}

// --- Steps -----------------------------------------------------------------------------------------------------------

/// Solves the last step again with the settings as they are now.
void SessionCore::amend() {
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
  step.region.connect_gap = settings.connect_gap;
  if (step.region.kind == RegionSpec::Kind::Radius) {
    step.region.radius = std::max(settings.radius - selection.discs.reach, (1 - kLargestHandleShare) * settings.radius);
  }
  const EditStep written = mirrored(*amending.base, step);
  std::vector<std::vector<int>> handles;
  std::vector<std::vector<double>> weights;
  std::vector<Affine> maps;
  for (const HandleGroup& handle : written.handles) {
    handles.push_back(handle.vertices);
    weights.push_back(handle.weights);
    maps.push_back(resolve(handle.transform, centroid(amending.base->vertices, handle.vertices)));
  }
  preparation = Preparation::Running;
  in_hand = false;
  heard = DragFigures();
  worker.prepare({amending.base, adjacency, written.region, std::move(handles), step.settings, scalar,
                  std::move(weights), step.mirror});
  amending.serial = worker.solve(maps, true);
}

/// @return the mouse events that waited for the step, as all functions that commit one
MouseEvents SessionCore::commit_release() {
  Releasing& releasing = std::get<Releasing>(phase);
  EditStep step;
  step.region = selection.region;
  step.settings = settings.edit;
  step.mirror = tools.mirror;
  for (std::size_t g = 0; g < groups().size(); ++g) {
    step.handles.push_back({groups()[g], {}, selection.weights[g]});
  }
  step.handles[selection.active].transform = releasing.drag.motion.transform();
  const AppliedStep& applied = history.apply(std::move(step), shown.region()->mesh_vertex, shown.pose());
  history.set_discs(selection.discs);
  strokes = Strokes();
  show_mesh(applied.vertices, applied.after, true);
  log(messages::step_applied(history.steps().size(), releasing.drag.motion, groups()[selection.active],
                             shown.region()->size(), heard.prepare_ms.value_or(0), heard.solve_ms.value_or(0)) +
      (heard.advice.empty() ? "" : "; " + heard.advice));
  MouseEvents events = std::move(releasing.waiting);
  go_on();
  return events;
}

MouseEvents SessionCore::commit_amended() {
  Amending amending = std::move(std::get<Amending>(phase));
  const std::shared_ptr<const Region> region = shown.take_awaited();
  show(history.steps().back().vertices, history.steps().back().before, false);
  const AppliedStep& applied = history.amend(amending.step, region->mesh_vertex, solved.positions);
  history.set_discs(selection.discs);
  show_mesh(applied.vertices, applied.after, true);
  log(messages::step_amended(history.steps().size(), region->size(), heard.prepare_ms.value_or(0),
                             heard.solve_ms.value_or(0)));
  show_region(region);
  selection.region = std::move(amending.step.region);
  selection.has_region = true;
  go_on();
  return std::move(amending.waiting);
}

MouseEvents SessionCore::commit_loaded(const std::vector<EditResult>& results) {
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
void SessionCore::go_on() {
  shown.settle();
  selection = with_region_kept(surface(), selection);
  history.set_next_region(selection.region);
  phase = Picked{true};
  prepare();
}

/// Goes back to the handle and the region of a step. @param applied  its region then is a set
void SessionCore::take_over(const AppliedStep& step, bool applied) {
  selection = selection_of(step, applied, selection, settings);
  tools.mirror = step.step.mirror;
  strokes = Strokes();
  heard = DragFigures();
  shown.await(nullptr);
  if (shown.region()) {
    show_region(shown.region());
  }
  prepare();
  rest(applied);
}

// --- News of the worker ----------------------------------------------------------------------------------------------

void SessionCore::on_error(const std::string& sentence) {
  preparation = Preparation::None;
  in_hand = false;
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
MouseEvents SessionCore::take_pose() {
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

/// What of a region made by hand no handle reaches.
void SessionCore::find_unconnected(const Region& region) {
  unconnected.clear();
  if (region.left_out > 0 && !in<Amending>() && !in<Loading>()) {
    unconnected = without(sorted_set(selection.region.vertices), region.mesh_vertex);
  }
}

/// Takes what is new. @param waited  gets the mouse events that waited for a step that is done now
bool SessionCore::listen(MouseEvents& waited) {
  const SolverNews news = worker.poll(solved);
  if (news.region) {
    find_unconnected(*news.region);
    if (shown.away() || in<Amending>() || in<Loading>()) {
      shown.await(news.region);
    } else {
      show_region(news.region);
    }
  }
  if (news.in_hand) {
    in_hand = true;
    heard.in_hand_ms = news.in_hand_ms;
  }
  if (news.ready) {
    preparation = Preparation::Done;
    heard.taken_over = news.taken_over;
    heard.prepare_ms = news.prepare_ms;
  }
  if (news.report) {
    heard.handle_error = news.report->handle_residual;
    heard.largest_stretch = news.report->stretch_max;
    heard.advice = news.report->advice();
  }
  if (news.pose) {
    waited = take_pose();
  }
  if (news.applied) {
    waited = commit_loaded(*news.applied);
  }
  if (!news.error.empty()) {
    on_error(news.error);
  }
  if (!news.pose_error.empty()) {
    if (waiting()) {
      log(messages::not_possible(news.pose_error));
      drop();
    }
    refusal = news.pose_error;
  }
  return news.region || news.in_hand || news.ready || news.report || news.pose || news.applied || !news.error.empty() ||
         !news.pose_error.empty();
}

}  // namespace lapedit
