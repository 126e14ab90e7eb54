// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/session_solver.h"

#include <algorithm>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/messages.h"

namespace lapedit {

using namespace phase;

namespace {

/// Returns the weight of a point's displacement at a fraction of the path from its neighbour to the point.
/// @param free_point, free_neighbour  whether the point, or its neighbour, is an end of the curve
double rise(double fraction, bool free_point, bool free_neighbour) {
  if (free_point && free_neighbour) {
    return fraction;
  }
  return free_point       ? fraction * fraction
         : free_neighbour ? 1 - (1 - fraction) * (1 - fraction)
                          : fraction * fraction * (3 - 2 * fraction);
}

/// Returns the point of a curve near the mirror image of another point, -1 if there is none.
int mirrored_point(const TriangleMesh& mesh, const HandleCurve& curve, int point, const Affine& mirror) {
  constexpr double kOfWay = 0.25;  // of the distance from the point to its image
  const Vector3 position = position_of(mesh.vertices, curve.path[curve.points[point]]), image = mirror * position;
  double nearest = kOfWay * (image - position).norm();
  int found = -1;
  for (int k = 0; k < static_cast<int>(curve.points.size()); ++k) {
    const double distance = (position_of(mesh.vertices, curve.path[curve.points[k]]) - image).norm();
    if (k != point && distance < nearest) {
      nearest = distance;
      found = k;
    }
  }
  return found;
}

}  // namespace

std::vector<double> bend_weights(const TriangleMesh& mesh, const std::vector<int>& group, const HandleCurve& curve,
                                 int point) {
  const std::vector<int>& path = curve.path;
  std::vector<double> length(path.size(), 0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    length[i] = length[i - 1] + (position_of(mesh.vertices, path[i]) - position_of(mesh.vertices, path[i - 1])).norm();
  }
  const bool closed = path.front() == path.back();
  const int last = static_cast<int>(curve.points.size()) - 1;
  const auto is_free = [&](int k) { return !closed && (k == 0 || k == last); };
  std::vector<double> weights(group.size(), 0);
  const auto spread = [&](int k) {
    for (const int neighbour : {k - 1, k + 1}) {
      if (neighbour < 0 || neighbour > last) {
        continue;
      }
      const double to = length[curve.points[k]], from = length[curve.points[neighbour]];
      for (int i = std::min(curve.points[k], curve.points[neighbour]);
           i <= std::max(curve.points[k], curve.points[neighbour]); ++i) {
        const double fraction = to != from ? (length[i] - from) / (to - from) : i == curve.points[k] ? 1 : 0;
        if (const int at = index_in(group, path[i]); at >= 0) {
          weights[at] = std::max(weights[at], rise(fraction, is_free(k), is_free(neighbour)));
        }
      }
    }
  };
  spread(point);
  if (closed && (point == 0 || point == last)) {
    spread(last - point);
  }
  return weights;
}

SessionSolver::SessionSolver(SessionModel& model, std::function<void()> wake)
    : model_(model), worker_(std::move(wake)) {}

bool SessionSolver::adjustable() const {
  const Picked* const picked = in<Picked>();
  return (picked && picked->adjustable) || in<Adjusting>();
}

Surface SessionSolver::surface() {
  HoverSearch* const search = model_.search();
  return {model_.mesh(),
          *model_.adjacency,
          model_.settings,
          model_.shown.region().get(),
          preparation_.has_preview,
          search ? &search->discs() : nullptr};
}

DragFigures SessionSolver::figures() const {
  DragFigures figures = figures_;
  if (const Region* const region = model_.shown.region().get()) {
    figures.pieces = region->pieces;
    figures.handle = model_.shown.count(VertexClass::Handle);
    figures.free = model_.shown.count(VertexClass::Free);
    figures.anchors = model_.shown.count(VertexClass::Anchor);
    figures.fixed = static_cast<int>(model_.mesh().vertices.rows()) - region->size() - model_.others;
  }
  figures.steps = static_cast<int>(model_.history.steps().size());
  return figures;
}

// --- Regions ---------------------------------------------------------------------------------------------------------

/// Returns the settings of a drag, which keeps the detail.
EditSettings SessionSolver::plain_settings() const {
  EditSettings settings = model_.settings.edit;
  settings.detail = 1;
  return settings;
}

void SessionSolver::rest(bool adjustable) {
  const AppliedStep* const last = adjustable && model_.history.can_undo() ? &model_.history.steps().back() : nullptr;
  model_.settings.edit.detail = last ? last->step.settings.detail : 1;
  if (model_.groups().empty() && !(last && last->step.handles.empty() && !last->step.fit)) {
    phase_ = Idle();
  } else {
    phase_ = Picked{adjustable};
  }
}

void SessionSolver::handles_changed() {
  figures_ = DragFigures();  // the old figures are of another handle or region
  rest(false);
  prepare();
}

void SessionSolver::request_preparation(PrepareTask task) {
  preparation_ = Preparation();
  preparation_.running = true;
  worker_.prepare(std::move(task));
}

void SessionSolver::prepare() {
  ToolState& tools = model_.tools;
  tools.mirrored.reset();
  const Selection& selection = model_.selection;
  if (selection.groups.empty()) {
    preparation_ = {};
    worker_.cancel();
    return;
  }
  PrepareTask task{model_.history.mesh(), model_.adjacency, selection.region,  selection.groups,
                   plain_settings(),      model_.scalar,    selection.weights, tools.mirror};
  if (tools.mirror) {
    try {
      tools.mirrored =
          std::make_unique<MirroredHandles>(model_.mesh(), selection.groups, *tools.mirror, selection.weights);
      task.groups = tools.mirrored->groups();
      task.weights = tools.mirrored->weights();
      task.region = mirrored(model_.mesh(), selection.region, *tools.mirror);
    } catch (const EditError& error) {
      worker_.cancel();
      on_error(error.what());
      return;
    }
  }
  request_preparation(std::move(task));
}

// --- Drags -----------------------------------------------------------------------------------------------------------

bool SessionSolver::begin(MotionKind kind, const Vector3& grab, const Cursor& cursor, bool by_button) {
  if (!model_.has_active_group() || !cursor.view.valid()) {
    return false;
  }
  const std::vector<int>& group = model_.active_group();
  const bool alone = model_.selection.along.empty();
  if (kind != MotionKind::Translate && group.size() == 1 && alone && model_.tools.pivot == Pivot::Centroid) {
    model_.refusal =
        format_text(messages::kSingleVertex, kind == MotionKind::Rotate ? "Turning" : "Scaling", group.front());
    return false;
  }
  if (!preparation_.running && !preparation_.has_preview) {
    prepare();  // a preparation failed before: report the reason again
    if (!preparation_.running && !preparation_.ready) {
      return false;
    }
  }
  if (kind == MotionKind::Translate) {
    ToolState& tools = model_.tools;
    tools.targets = tools.snaps && model_.find_targets ? model_.find_targets() : nullptr;
  }
  const bool about_pivot = kind != MotionKind::Translate && (model_.tools.pivot != Pivot::Centroid || !alone);
  DragMotion motion(kind, grab, model_.center(), mean_normal(model_.mesh(), *model_.adjacency, group), cursor,
                    about_pivot ? std::optional(model_.pivot_position()) : std::nullopt, model_.settings.radius);
  if (Dragging* const drag = in<Dragging>()) {
    drag->motion = motion;
    if (kind != MotionKind::Translate) {
      drag->bend.clear();
    }
  } else {
    phase_ = Dragging{motion, by_button};
    model_.settings.edit.detail = 1;
  }
  return true;
}

void SessionSolver::bend(int point) {
  Dragging& drag = std::get<Dragging>(phase_);
  const HandleCurve& curve = model_.selection.discs.curves[model_.selection.active];
  drag.bend = bend_weights(model_.mesh(), model_.active_group(), curve, point);
  drag.mirrored_bend.assign(drag.bend.size(), 0);
  const std::optional<MirrorPlane>& plane = model_.tools.mirror;
  const int image = plane ? mirrored_point(model_.mesh(), curve, point, reflection(*plane)) : -1;
  if (image >= 0) {
    drag.mirrored_bend = bend_weights(model_.mesh(), model_.active_group(), curve, image);
  }
}

/// Computes the targets of a bent curve; the lists are empty for other drags.
void SessionSolver::set_targets(Dragging& drag) const {
  drag.targets.resize(model_.groups().size());
  for (std::size_t g = 0; g < drag.targets.size(); ++g) {
    std::vector<Vector3>& targets = drag.targets[g];
    targets.clear();
    if (drag.bend.empty() || static_cast<int>(g) != model_.selection.active) {
      continue;
    }
    const Vector3 moved = drag.motion.transform().translation;
    const std::optional<MirrorPlane>& plane = model_.tools.mirror;
    const Vector3 image = plane ? Vector3(reflection(*plane).linear() * moved) : moved;
    for (std::size_t k = 0; k < drag.bend.size(); ++k) {
      targets.push_back(model_.mesh().vertices.row(model_.groups()[g][k]).transpose() + drag.bend[k] * moved +
                        drag.mirrored_bend[k] * image);
    }
  }
}

void SessionSolver::request() {
  Dragging& drag = std::get<Dragging>(phase_);
  const std::vector<std::vector<int>>& groups = model_.groups();
  drag.given.resize(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const bool moves = model_.selection.moves(static_cast<int>(g)) && drag.bend.empty();
    drag.given[g] = moves ? drag.motion.transform() : HandleTransform();
  }
  set_targets(drag);
  const std::vector<std::vector<int>>& all = model_.all_groups();
  try {
    drag.maps.resize(all.size());
    if (model_.tools.mirrored) {
      model_.tools.mirrored->maps(drag.given, drag.maps);
    }
    for (std::size_t g = 0; g < all.size(); ++g) {
      if (model_.tools.mirrored) {
        model_.tools.mirrored->targets(g, drag.targets, drag.all_targets);
      } else {
        const HandleMotion motion = resolve(drag.given[g], centroid(model_.mesh().vertices, all[g]));
        drag.maps[g].map = motion.map;
        drag.maps[g].rotation = motion.rotation;
      }
      targets_to(all[g], model_.tools.mirrored ? drag.all_targets : drag.targets[g], model_.mesh(),
                 drag.maps[g].targets);
    }
  } catch (const EditError& error) {
    model_.refusal = error.what();  // the next solve leaves the groups where they are
    drag.maps.assign(model_.all_groups().size(), HandleMotion());
  }
  drag.last_serial = worker_.solve(drag.maps, drag.released);
  drag.first_serial = std::min(drag.first_serial, drag.last_serial);
}

void SessionSolver::release() {
  Dragging& drag = std::get<Dragging>(phase_);
  if (!drag.motion.moves()) {
    discard();
    return;
  }
  drag.released = true;
  request();
}

void SessionSolver::discard() {
  figures_.report = nullptr;
  const Loading* const loading = in<Loading>();
  const bool elsewhere = loading || in<Adjusting>();  // the worker has prepared another region than the selection's
  if (const Adjusting* const adjusting = in<Adjusting>(); adjusting && adjusting->region) {
    const std::vector<int>& vertices = adjusting->region->mesh_vertex;
    model_.show(vertices, gather(model_.mesh().vertices, vertices), true);
  }
  rest(loading ? loading->adjustable : adjustable() && !(in<Adjusting>() && in<Adjusting>()->is_new));
  if (std::shared_ptr<const Region> awaited = model_.shown.take_awaited()) {
    model_.back_to_mesh(true);
    model_.show_region(std::move(awaited));
  }
  model_.back_to_mesh(true);
  if (elsewhere && model_.selection.by_hand && model_.groups().empty()) {
    model_.show_by_hand();
  }
  if (elsewhere) {
    prepare();
  }
}

// --- Steps -----------------------------------------------------------------------------------------------------------

std::optional<LastStep> SessionSolver::last_step() const {
  const Adjusting* const adjusting = in<Adjusting>();
  if (!adjustable() || !model_.history.can_undo()) {
    return std::nullopt;
  }
  const StepPath& path = adjusting ? adjusting->path : model_.history.steps().back().path;
  if (path.moved.empty()) {
    return std::nullopt;
  }
  const HandleGroup& handle = path.whole[path.moved.back()];
  if (handle.transform.matrix) {
    return std::nullopt;
  }
  const bool single = path.moved.size() == 1 && handle.vertices.size() == 1 && !handle.transform.center;
  return LastStep{handle.transform, path.fraction, !handle.targets.empty(), single};
}

void SessionSolver::begin_adjusting() {
  if (!in<Adjusting>()) {
    const AppliedStep& last = model_.history.steps().back();
    phase_ = Adjusting{last.step, model_.history.before_last(), last.path};
  }
}

void SessionSolver::begin_detail(bool open) {
  const Selection& selection = model_.selection;
  const bool is_known = !model_.groups().empty() ? model_.shown.region() && preparation_.ready : selection.by_hand;
  const bool has_boundary = selection.region.kind != RegionSpec::Kind::Component;
  if (!is_known || !has_boundary) {
    model_.refusal = preparation_.running ? messages::kRegionNotKnown
                     : is_known           ? messages::kNoBoundary
                                          : messages::kNoRegion;
    model_.settings.edit.detail = 1;
    return;
  }
  EditStep step;
  step.region = (selection.by_hand ? with_margin : with_region_kept)(surface(), selection).region;
  step.mirror = model_.tools.mirror;
  step.settings = model_.settings.edit;
  phase_ = Adjusting{std::move(step), model_.history.mesh(), {}, true, open};
  request_adjusted(true);
}

void SessionSolver::adjust(bool open) {
  begin_adjusting();
  in<Adjusting>()->open = open;
  const DragSettings& settings = model_.settings;
  EditStep& step = in<Adjusting>()->step;
  step.settings = settings.edit;
  set_options(step.region, settings);
  if (step.region.kind == RegionSpec::Kind::Radius) {
    step.region.radius =
        std::max(settings.radius - model_.selection.discs.reach, (1 - kLargestHandleFraction) * settings.radius);
  }
  request_adjusted(true);
}

void SessionSolver::adjust_path(const HandleTransform& motion, double fraction, bool open) {
  const bool prepares = !in<Adjusting>();
  begin_adjusting();
  Adjusting& adjusting = *in<Adjusting>();
  adjusting.open = open;
  adjusting.path.fraction = fraction;
  HandleTransform whole = motion;
  const std::vector<int>& moved = adjusting.path.moved;
  if (moved.size() > 1 && !whole.center && (whole.degrees != 0 || whole.scale != 1)) {
    std::vector<int> vertices;
    for (const int g : moved) {
      vertices = united(vertices, adjusting.path.whole[g].vertices);
    }
    whole.center = centroid(adjusting.base->vertices, vertices);
  }
  for (const int g : moved) {
    HandleGroup& handle = adjusting.path.whole[g];
    if (handle.targets.empty()) {
      handle.transform = whole;
    }
  }
  adjusting.step.handles = path_fraction(adjusting.path, *adjusting.base);
  request_adjusted(prepares);
}

void SessionSolver::request_adjusted(bool prepares) {
  Adjusting& adjusting = *in<Adjusting>();
  EditStep written = mirrored(*adjusting.base, adjusting.step);
  for (std::size_t g = 0; g < written.handles.size(); ++g) {
    sort_group(written.handles[g], g);
  }
  written.region.without_handle = written.handles.empty();
  if (prepares) {
    figures_ = DragFigures();
    adjusting.region = nullptr;
    adjusting.first_serial = std::numeric_limits<int>::max();
    request_preparation({adjusting.base, model_.adjacency, written.region, groups_of(written), adjusting.step.settings,
                         model_.scalar, weights_of(written), adjusting.step.mirror});
  }
  adjusting.serial = worker_.solve(motions_of(*adjusting.base, written), !adjusting.open);
  adjusting.first_serial = std::min(adjusting.first_serial, adjusting.serial);
}

/// Shows a pose of the step while changes continue.
void SessionSolver::show_adjusted(const Adjusting& adjusting) {
  const std::vector<int>& vertices = adjusting.region->mesh_vertex;
  ShownRegion& shown = model_.shown;
  if (!shown.region() || shown.region()->mesh_vertex != vertices) {
    model_.show_region(adjusting.region);
  }
  shown.pose(solved_.positions);
  model_.show(vertices, shown.pose(), false);
}

void SessionSolver::load(Edit edit) {
  preparation_.running = true;
  worker_.apply({model_.given_mesh(), model_.given_adjacency, edit, model_.scalar});
  phase_ = Loading{std::move(edit), adjustable()};
}

void SessionSolver::take_over(bool applied) {
  figures_ = DragFigures();
  model_.shown.await(nullptr);
  if (model_.shown.region()) {
    model_.show_region(model_.shown.region());
  }
  prepare();
  rest(applied);
}

/// Makes a solved step one of the history, and shows it.
const AppliedStep& SessionSolver::apply(EditStep step, EditResult pose, std::optional<StepPath> path) {
  const AppliedStep& applied =
      model_.history.apply(std::move(step), std::move(pose.vertices), std::move(pose.positions), std::move(path));
  model_.show(applied.vertices, applied.after, true);
  return applied;
}

void SessionSolver::commit_drag() {
  const Dragging& drag = std::get<Dragging>(phase_);
  const Selection selection = model_.selection;
  EditStep step;
  step.region = selection.region;
  step.settings = plain_settings();
  step.mirror = model_.tools.mirror;
  for (std::size_t g = 0; g < selection.groups.size(); ++g) {
    step.handles.push_back({selection.groups[g], drag.given[g], selection.weights[g], drag.targets[g]});
  }
  StepPath path{step.handles, united(selection.along, {selection.active}), 1};
  apply(std::move(step), model_.with_others(model_.shown.region()->mesh_vertex, model_.shown.pose()), std::move(path));
  model_.timeline.add({drag.motion.text(), true, selection});
  model_.log(messages::step_applied(model_.history.steps().size(), drag.motion, model_.active_group(),
                                    model_.shown.region()->size()) +
             (figures_.advice().empty() ? "" : "; " + figures_.advice()));
  progress();
}

void SessionSolver::commit_adjusted() {
  Adjusting& adjusting = std::get<Adjusting>(phase_);
  History& history = model_.history;
  const std::shared_ptr<const Region> region = adjusting.region;
  model_.shown.await(nullptr);
  std::optional<StepPath> path;
  if (!adjusting.is_new) {
    const AppliedStep& former = history.undo();
    model_.show(former.vertices, former.before, false);
    path = std::move(adjusting.path);
  }
  apply(adjusting.step, model_.with_others(region->mesh_vertex, solved_.positions), std::move(path));
  if (adjusting.is_new) {
    model_.timeline.add({messages::name_of(adjusting.step, {}), true, model_.selection});
  }
  model_.log(format_text(messages::kStepAdjusted, history.steps().size(),
                         adjusting.is_new ? ": another detail" : " again with other settings", region->size()));
  Selection& selection = model_.selection;
  if (selection.by_hand && adjusting.step.handles.empty()) {
    model_.show_by_hand();  // without the margin
  } else {
    model_.show_region(region);
    selection.region = std::move(adjusting.step.region);
    selection.has_region = true;
  }
  progress();
}

void SessionSolver::commit_loaded(const std::vector<EditResult>& results) {
  Edit& edit = std::get<Loading>(phase_).edit;
  for (std::size_t k = 0; k < results.size(); ++k) {
    EditStep& step = edit.steps[k];
    const AppliedStep& applied = apply(welded(std::move(step), model_.weld), results[k]);
    Selection& selection = model_.selection;
    selection = selection_of(applied.step, applied.path.moved, selection, model_.settings);
    Action action{messages::name_of(applied.step, applied.path.moved), true, selection};
    if (selection.has_region && selection.region.kind == RegionSpec::Kind::Radius) {
      selection = with_vertices(std::move(selection), model_.weld.representatives(applied.vertices), model_.settings);
    }
    action.after = selection;
    model_.timeline.add(std::move(action));
  }
  model_.log(format_text(messages::kEditApplied, results.size(), results.size() == 1 ? "" : "s"));
  for (std::size_t k = 0; k < results.size(); ++k) {
    if (const std::string advice = results[k].reports.front().advice(); !advice.empty()) {
      model_.log(format_text(messages::kLoadedStepAdvice, k + 1, advice.c_str()));
    }
  }
  model_.tools.mirror = model_.history.steps().back().step.mirror;
  take_over(true);
}

/// Prepares the next drag from the current mesh in the same region.
void SessionSolver::progress() {
  model_.shown.settle();
  model_.selection = with_region_kept(surface(), model_.selection);
  model_.timeline.change_last().after = model_.selection;
  rest(true);
  prepare();
}

// --- Answers ---------------------------------------------------------------------------------------------------------

void SessionSolver::on_error(const std::string& sentence) {
  preparation_ = {};
  model_.log(format_text(messages::kNotPossible, sentence.c_str()));
  if (in_progress()) {
    discard();
  }
  if (!model_.shown.region() || !model_.selection.has_region) {
    model_.show_region(nullptr);
  }
  model_.refusal = sentence;
}

/// @return whether the pose completes a step
bool SessionSolver::take_pose() {
  if (const Adjusting* const adjusting = in<Adjusting>()) {
    if (solved_.serial < adjusting->first_serial || !adjusting->region ||
        solved_.positions.rows() != adjusting->region->size()) {
      return false;
    }
    if (adjusting->open || solved_.serial != adjusting->serial) {
      show_adjusted(*adjusting);
      return false;
    }
    commit_adjusted();
    return true;
  }
  const Dragging* const drag = in<Dragging>();
  if (!drag || solved_.serial < drag->first_serial) {
    return false;
  }
  ShownRegion& shown = model_.shown;
  if (std::shared_ptr<const Region> awaited = shown.take_awaited()) {
    model_.back_to_mesh(false);
    model_.show_region(std::move(awaited));
  }
  if (!shown.region() || solved_.positions.rows() != shown.region()->size()) {
    if (drag->released) {
      discard();
    }
    return false;
  }
  shown.pose(solved_.positions);
  if (drag->released && solved_.serial == drag->last_serial) {
    commit_drag();
    return true;
  }
  model_.show(shown.region()->mesh_vertex, shown.pose(), false);
  return false;
}

/// Finds the vertices of a painted region that no handle reaches.
void SessionSolver::find_unconnected(const Region& region) {
  model_.unconnected.clear();
  if (region.left_out > 0 && model_.selection.by_hand && !in<Adjusting>() && !in<Loading>()) {
    model_.unconnected = without(sorted_set(model_.selection.region.vertices), region.mesh_vertex);
  }
}

SessionSolver::Response SessionSolver::poll() {
  const SolverUpdate update = worker_.poll(solved_);
  bool step_done = false;
  if (update.region) {
    find_unconnected(*update.region);
    if (Adjusting* const adjusting = in<Adjusting>()) {
      adjusting->region = update.region;
    }
    if (model_.shown.away() || in<Adjusting>() || in<Loading>()) {
      model_.shown.await(update.region);
    } else {
      model_.show_region(update.region);
    }
  }
  preparation_.has_preview |= update.preview;
  if (update.ready) {
    preparation_ = Preparation();
    preparation_.has_preview = preparation_.ready = true;
    figures_.full_frames = update.full_frames;
  }
  if (update.report) {
    figures_.report = update.report;
  }
  if (update.pose) {
    step_done = take_pose();
  }
  if (update.applied) {
    commit_loaded(*update.applied);
    step_done = true;
  }
  if (!update.error.empty()) {
    on_error(update.error);
  }
  if (!update.pose_error.empty()) {
    if (waits()) {
      model_.log(format_text(messages::kNotPossible, update.pose_error.c_str()));
      discard();
    }
    model_.refusal = update.pose_error;
  }
  return step_done ? Response::Step : update.any() ? Response::Some : Response::None;
}

}  // namespace lapedit
