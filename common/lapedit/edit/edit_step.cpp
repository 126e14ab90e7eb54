// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/edit_step.h"

#include <algorithm>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

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

std::vector<Affine> targets(const TriangleMesh& mesh, const EditStep& step, double fraction) {
  std::vector<Affine> maps;
  for (const HandleGroup& handle : step.handles) {
    maps.push_back(resolve(handle.transform, centroid(mesh.vertices, handle.vertices), fraction));
  }
  return maps;
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

}  // namespace lapedit
