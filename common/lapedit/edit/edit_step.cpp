// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/edit_step.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

std::string group_name(std::size_t number) {
  return "Handle group " + std::to_string(number);
}

/// A single vertex has no rotation and no scale of its own.
void check_handle(const HandleGroup& handle, std::size_t number) {
  const HandleTransform& transform = handle.transform;
  const bool alone = handle.vertices.size() == 1 && !transform.matrix && !transform.center;
  if (alone && (transform.degrees != 0 || transform.scale != 1)) {
    const std::string what = transform.degrees != 0
                                 ? "cannot be rotated by " + number_text(transform.degrees) + " degrees"
                                 : "cannot be scaled by " + number_text(transform.scale);
    throw EditError(ErrorCause::BadParameter, group_name(number) + " is vertex " +
                                                  std::to_string(handle.vertices.front()) + " alone, which " + what +
                                                  " about itself: name several vertices, or give a translation.");
  }
}

void require_finite_targets(const HandleGroup& handle, std::size_t number) {
  for (std::size_t k = 0; k < handle.targets.size(); ++k) {
    if (!handle.targets[k].allFinite()) {
      throw EditError(ErrorCause::NotFinite,
                      "The target of vertex " + std::to_string(handle.vertices[k]) + " in handle group " +
                          std::to_string(number) + " is not finite: give finite coordinates.",
                      handle.vertices[k]);
    }
  }
}

}  // namespace

void targets_to(const std::vector<int>& vertices, const std::vector<Vector3>& targets, const TriangleMesh& mesh,
                Points& rows) {
  rows.resize(static_cast<Eigen::Index>(targets.size()), 3);
  bool elsewhere = false;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    rows.row(static_cast<Eigen::Index>(k)) = targets[k].transpose();
    elsewhere |= targets[k] != mesh.vertices.row(vertices[k]).transpose();
  }
  if (!elsewhere) {
    rows.resize(0, 3);
  }
}

Vector3 centroid(const Points& vertices, const std::vector<int>& group) {
  if (group.empty()) {
    throw EditError(ErrorCause::NoHandle, "A handle group has no vertices: name at least one vertex to move.");
  }
  for (const int v : group) {
    require_vertex("Handle vertex", v, vertices.rows());
  }
  Vector3 offset = Vector3::Zero();
  const Vector3 first = vertices.row(group.front()).transpose();
  for (const int v : group) {
    offset += vertices.row(v).transpose() - first;
  }
  return first + offset / static_cast<double>(group.size());
}

std::vector<std::vector<int>> groups_of(const EditStep& step) {
  std::vector<std::vector<int>> groups;
  for (const HandleGroup& handle : step.handles) {
    groups.push_back(handle.vertices);
  }
  return groups;
}

std::vector<std::vector<double>> weights_of(const EditStep& step) {
  std::vector<std::vector<double>> weights;
  for (const HandleGroup& handle : step.handles) {
    weights.push_back(handle.weights);
  }
  return weights;
}

std::vector<HandleMotion> motions_of(const TriangleMesh& mesh, const EditStep& step, double fraction) {
  std::vector<HandleMotion> motions;
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    const HandleGroup& handle = step.handles[g];
    HandleMotion motion = resolve(handle.transform, centroid(mesh.vertices, handle.vertices));
    check_handle(handle, g);
    motion.fraction = fraction;
    require_finite_targets(handle, g);
    targets_to(handle.vertices, handle.targets, mesh, motion.targets);
    motions.push_back(std::move(motion));
  }
  return motions;
}

void check_handles(const EditStep& step) {
  for (std::size_t g = 0; g < step.handles.size(); ++g) {
    check_handle(step.handles[g], g);
  }
}

void sort_group(std::vector<int>& vertices, std::vector<double>& weights) {
  if (!weights.empty() && weights.size() != vertices.size()) {
    throw EditError(ErrorCause::BadParameter, "A handle group has " + std::to_string(vertices.size()) +
                                                  " vertices and " + std::to_string(weights.size()) +
                                                  " weights: give one weight for each vertex, or none at all.");
  }
  if (weights.empty()) {
    vertices = sorted_set(std::move(vertices));
    return;
  }
  std::vector<std::pair<int, double>> pairs;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    pairs.emplace_back(vertices[k], -weights[k]);
  }
  std::sort(pairs.begin(), pairs.end());
  vertices.clear();
  weights.clear();
  for (const auto& [vertex, weight] : pairs) {
    if (vertices.empty() || vertices.back() != vertex) {
      vertices.push_back(vertex);
      weights.push_back(-weight);
    }
  }
}

void sort_group(HandleGroup& group, std::size_t number) {
  if (group.targets.empty()) {
    sort_group(group.vertices, group.weights);
    return;
  }
  if (group.targets.size() != group.vertices.size()) {
    throw EditError(ErrorCause::BadParameter, group_name(number) + " has " + std::to_string(group.vertices.size()) +
                                                  " vertices and " + std::to_string(group.targets.size()) +
                                                  " targets: give one target for each vertex, in the same order.");
  }
  std::vector<std::size_t> order(group.vertices.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return group.vertices[a] < group.vertices[b]; });
  std::vector<Vector3> targets;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || group.vertices[order[k]] != group.vertices[order[k - 1]]) {
      targets.push_back(group.targets[order[k]]);
      if (order[k] < group.names.size()) {
        names.push_back(group.names[order[k]]);
      }
    } else if (group.targets[order[k]] != targets.back()) {
      throw EditError(ErrorCause::BadParameter, group_name(number) + " has vertex " +
                                                    std::to_string(group.vertices[order[k]]) +
                                                    " twice, with different targets: give one target for it.");
    }
  }
  sort_group(group.vertices, group.weights);
  group.targets = std::move(targets);
  group.names = std::move(names);
}

}  // namespace lapedit
