// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/session_model.h"

#include <utility>

#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

std::vector<HandleGroup> path_fraction(const StepPath& path, const TriangleMesh& rest) {
  std::vector<HandleGroup> handles = path.whole;
  const double fraction = path.fraction;
  for (HandleGroup& handle : handles) {
    if (fraction == 1) {
      break;
    }
    HandleTransform& transform = handle.transform;
    transform.translation = fraction * transform.translation + Vector3::Zero();  // without negative zeros
    transform.degrees = fraction * transform.degrees + 0.0;
    transform.scale = 1 + fraction * (transform.scale - 1);
    for (std::size_t k = 0; k < handle.targets.size(); ++k) {
      const Vector3 position = rest.vertices.row(handle.vertices[k]).transpose();
      handle.targets[k] = fraction == 0 ? position : Vector3(position + fraction * (handle.targets[k] - position));
    }
  }
  return handles;
}

StepPath path_of(const EditStep& step) {
  StepPath path{step.handles, {}, 1};
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    const HandleGroup& handle = step.handles[g];
    if (!handle.targets.empty() || !resolve(handle.transform, Vector3::Zero()).map.matrix().isIdentity(0)) {
      path.moved.push_back(static_cast<int>(g));
    }
  }
  return path;
}

History::History(TriangleMesh original)
    : mesh_(std::make_shared<TriangleMesh>(std::move(original))), original_(mesh_) {}

/// Gives some vertices other positions.
void History::change(const std::vector<int>& vertices, const Points& positions) {
  if (std::exchange(is_shared_, false)) {
    mesh_ = std::make_shared<TriangleMesh>(*mesh_);
  }
  scatter(vertices, positions, mesh_->vertices);
}

std::shared_ptr<const TriangleMesh> History::before_last() const {
  auto mesh = std::make_shared<TriangleMesh>(*mesh_);
  scatter(steps_.back().vertices, steps_.back().before, mesh->vertices);
  return mesh;
}

Edit History::recorded() const {
  Edit edit;
  edit.mesh_vertices = static_cast<int>(original_->vertices.rows());
  edit.mesh_faces = static_cast<int>(original_->faces.rows());
  if (checksum_.empty()) {
    checksum_ = connectivity_checksum(static_cast<std::size_t>(original_->vertices.rows()), original_->faces);
  }
  edit.connectivity = checksum_;
  for (const AppliedStep& applied : steps_) {
    edit.steps.push_back(applied.step);
  }
  return edit;
}

const AppliedStep& History::apply(EditStep step, std::vector<int> vertices, Points after,
                                  std::optional<StepPath> path) {
  undone_.clear();
  path = path ? std::move(path) : path_of(step);
  Points before = gather(mesh_->vertices, vertices);
  change(vertices, after);
  steps_.push_back({std::move(step), std::move(vertices), std::move(before), std::move(after), std::move(*path)});
  return steps_.back();
}

void History::set_faces(Faces faces) {
  mesh_ = std::make_shared<TriangleMesh>(TriangleMesh{mesh_->vertices, std::move(faces)});
}

const AppliedStep& History::undo() {
  undone_.push_back(std::move(steps_.back()));
  steps_.pop_back();
  change(undone_.back().vertices, undone_.back().before);
  return undone_.back();
}

const AppliedStep& History::redo() {
  steps_.push_back(std::move(undone_.back()));
  undone_.pop_back();
  change(steps_.back().vertices, steps_.back().after);
  return steps_.back();
}

}  // namespace lapedit
