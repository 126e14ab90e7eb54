// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/session_model.h"

#include <mutex>
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

/// Meshes with the faces of mesh() that no thread reads any more, so that steps copy positions only.
struct History::Spares {
  static constexpr std::size_t kMost = 4;

  /// Makes the meshes for the first steps, since after each step other threads still read the previous mesh.
  explicit Spares(const TriangleMesh& mesh) {
    list.reserve(kMost);  // so that giving back does not throw
    for (int k = 0; k < 3; ++k) {
      list.push_back(std::make_unique<TriangleMesh>(mesh));
    }
  }

  std::mutex mutex;
  std::vector<std::unique_ptr<TriangleMesh>> list;  // under the mutex
};

History::History(TriangleMesh original)
    : original_(std::make_shared<const TriangleMesh>(std::move(original))),
      mesh_(original_),
      spares_(std::make_shared<Spares>(*mesh_)) {}

std::shared_ptr<const TriangleMesh> History::with(const std::vector<int>& vertices, const Points& positions) const {
  std::unique_ptr<TriangleMesh> mesh;
  if (const std::lock_guard<std::mutex> lock(spares_->mutex); !spares_->list.empty()) {
    mesh = std::move(spares_->list.back());
    spares_->list.pop_back();
  }
  if (mesh != nullptr) {
    mesh->vertices = mesh_->vertices;
  } else {
    mesh = std::make_unique<TriangleMesh>(*mesh_);
  }
  scatter(vertices, positions, mesh->vertices);
  // The last reader gives the mesh back, on any thread.
  const auto give_back = [spares = spares_](TriangleMesh* read) {
    std::unique_ptr<TriangleMesh> owned(read);
    const std::lock_guard<std::mutex> lock(spares->mutex);
    if (spares->list.size() < Spares::kMost) {
      spares->list.push_back(std::move(owned));
    }
  };
  return {mesh.release(), give_back};
}

std::shared_ptr<const TriangleMesh> History::before_last() const {
  return with(steps_.back().vertices, steps_.back().before);
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
  mesh_ = with(vertices, after);
  steps_.push_back({std::move(step), std::move(vertices), std::move(before), std::move(after), std::move(*path)});
  return steps_.back();
}

void History::set_faces(Faces faces) {
  mesh_ = std::make_shared<const TriangleMesh>(TriangleMesh{mesh_->vertices, std::move(faces)});
  spares_ = std::make_shared<Spares>(*mesh_);
}

const AppliedStep& History::undo() {
  undone_.push_back(std::move(steps_.back()));
  steps_.pop_back();
  mesh_ = with(undone_.back().vertices, undone_.back().before);
  return undone_.back();
}

const AppliedStep& History::redo() {
  steps_.push_back(std::move(undone_.back()));
  undone_.pop_back();
  mesh_ = with(steps_.back().vertices, steps_.back().after);
  return steps_.back();
}

}  // namespace lapedit
