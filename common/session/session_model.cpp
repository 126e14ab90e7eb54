// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/session_model.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "lapedit/mesh/region.h"
#include "lapedit/mesh/surface_measures.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

TriangleMesh checked(TriangleMesh mesh) {
  validate(mesh);
  return mesh;
}

/// Joins two changes; newer positions replace older ones.
PoseChange joined(const PoseChange& older, const std::vector<int>& vertices, const Points& positions) {
  PoseChange all{united(older.vertices, vertices), {}};
  all.positions.resize(static_cast<Eigen::Index>(all.vertices.size()), 3);
  for (Eigen::Index row = 0; row < all.positions.rows(); ++row) {
    const int v = all.vertices[static_cast<std::size_t>(row)], position = index_in(vertices, v);
    all.positions.row(row) = position >= 0 ? positions.row(position) : older.positions.row(index_in(older.vertices, v));
  }
  return all;
}

}  // namespace

// --- The shown region ------------------------------------------------------------------------------------------------

void ShownRegion::show(std::shared_ptr<const Region> region, const TriangleMesh& mesh) {
  region_ = std::move(region);
  std::fill(std::begin(counts_), std::end(counts_), 0);
  held_by_nothing_ = 0;
  if (region_) {
    pose_ = gather(mesh.vertices, region_->mesh_vertex);
    for (const VertexClass c : region_->classes) {
      ++counts_[static_cast<int>(c)];
    }
    held_by_nothing_ = lapedit::held_by_nothing(*region_);
  }
  away_ = false;
  ++serial_;
  ++region_serial_;
}

void ShownRegion::pose(Points& positions) {
  pose_.swap(positions);
  away_ = true;
  ++serial_;
}

void ShownRegion::settle() {
  away_ = false;
  ++serial_;
}

bool ShownRegion::rest(const TriangleMesh& mesh) {
  if (!away_ || !region_) {
    return false;
  }
  pose_ = gather(mesh.vertices, region_->mesh_vertex);
  settle();
  return true;
}

// --- The session -----------------------------------------------------------------------------------------------------

SessionModel::SessionModel(TriangleMesh mesh, StoredScalar stored, const SessionCallbacks& callbacks)
    : scalar(stored),
      history(checked(std::move(mesh))),
      given_adjacency(std::make_shared<const Adjacency>(
          build_adjacency(static_cast<int>(history.original().vertices.rows()), history.original().faces))),
      adjacency(given_adjacency),
      log(callbacks.log ? callbacks.log : [](const std::string&) {}),
      find_targets(callbacks.find_targets),
      settings(settings_for(history.original())),
      background(callbacks.wake ? callbacks.wake : [] {}) {
  if (const auto joined = joined_surface(history.original()); joined != nullptr) {
    history.set_faces(joined->faces);
    adjacency = {joined, &joined->adjacency};
    weld = joined->weld;
  }
}

std::shared_ptr<const TriangleMesh> SessionModel::given_mesh() const {
  return adjacency == given_adjacency
             ? history.mesh()
             : std::make_shared<const TriangleMesh>(TriangleMesh{mesh().vertices, history.original().faces});
}

EditResult SessionModel::with_others(const std::vector<int>& vertices, const Points& positions) const {
  EditResult all{vertices, positions, {}};
  weld.add_others(all.vertices, all.positions);
  return all;
}

Vector3 SessionModel::center() const {
  if (selection.along.empty()) {
    return centroid(mesh().vertices, active_group());
  }
  Vector3 sum = Vector3::Zero();
  std::size_t count = 0;
  for (std::size_t g = 0; g < groups().size(); ++g) {
    if (selection.moves(static_cast<int>(g))) {
      sum += static_cast<double>(groups()[g].size()) * centroid(mesh().vertices, groups()[g]);
      count += groups()[g].size();
    }
  }
  return sum / static_cast<double>(count);
}

Vector3 SessionModel::pivot_position() const {
  const Region* const region = shown.region().get();
  if (tools.pivot == Pivot::Point && tools.pivot_vertex >= 0) {
    return mesh().vertices.row(tools.pivot_vertex).transpose();
  }
  return tools.pivot == Pivot::Boundary && region ? middle_of_boundary(mesh(), *region, active_group()) : center();
}

std::optional<Gizmo> SessionModel::gizmo(const Camera& view) const {
  const bool awaits_click = selection.next != Selection::Next::Handle || selection.mode == HandleMode::Curve ||
                            tools.awaits_pivot() || tools.paint;
  if (!tools.gizmo || awaits_click || selection.active < 0 || !view.valid()) {
    return std::nullopt;
  }
  Gizmo gizmo = place_gizmo(pivot_position(), tools.axes, mean_normal(mesh(), *adjacency, active_group()), view);
  gizmo.only_arrows = active_group().size() == 1 && selection.along.empty();
  return gizmo;
}

bool SessionModel::take(Choice choice) {
  if (const Refusal* const refused = std::get_if<Refusal>(&choice)) {
    refusal = refused->sentence;
    return false;
  }
  Selection& chosen = std::get<Selection>(choice);
  const bool another_region = chosen.taken != selection.taken;
  if (chosen.groups != selection.groups) {
    tools.gizmo &= !std::exchange(tools.gizmo_by_click, false);
    tools.mirrored.reset();  // a stroke is shown at once, its mirror image after preparation
  }
  selection = std::move(chosen);
  if (another_region) {
    show_region(nullptr);  // otherwise the old region would be taken for the new one
  }
  return true;
}

void SessionModel::show(const std::vector<int>& vertices, const Points& positions, bool settled) {
  settled |= changed_ && change_.settled;
  if (changed_ && vertices != shown_) {
    const EditResult all = with_others(vertices, positions);
    change_ = joined(change_, all.vertices, all.positions);
    shown_.clear();
  } else {
    if (vertices != shown_) {
      shown_ = change_.vertices = vertices;
      weld.add_others(change_.vertices, rows_);
    }
    change_.positions.resize(static_cast<Eigen::Index>(rows_.size()), 3);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      change_.positions.row(static_cast<Eigen::Index>(k)) = positions.row(rows_[k]);
    }
  }
  change_.settled = settled;
  changed_ = true;
}

void SessionModel::show_region(std::shared_ptr<const Region> region) {
  shown.show(std::move(region), mesh());
  others = 0;
  if (shown.region() && !weld.empty()) {
    std::vector<int> all = shown.region()->mesh_vertex, rows;
    weld.add_others(all, rows);
    others = static_cast<int>(all.size()) - shown.region()->size();
  }
}

void SessionModel::show_by_hand() {
  show_region(std::make_shared<const Region>(painted_region(mesh(), *adjacency, selection.region.vertices, groups())));
}

void SessionModel::back_to_mesh(bool settled) {
  if (shown.rest(mesh())) {
    show(shown.region()->mesh_vertex, shown.pose(), settled);
  }
}

bool SessionModel::undo() {
  Action& action = timeline.undo();
  Selection now = std::exchange(selection, with_padding(action.before, settings));
  if (action.is_step) {
    const AppliedStep& step = history.undo();
    tools.mirror = step.step.mirror;
    show(step.vertices, step.before, true);
  } else {
    action.after = std::move(now);
  }
  return action.is_step;
}

bool SessionModel::redo() {
  const Action& action = timeline.redo();
  selection = with_padding(action.after, settings);
  if (action.is_step) {
    const AppliedStep& step = history.redo();
    tools.mirror = step.step.mirror;
    show(step.vertices, step.after, true);
  }
  return action.is_step;
}

const PoseChange* SessionModel::take_change() {
  return std::exchange(changed_, false) ? &change_ : nullptr;
}

}  // namespace lapedit
