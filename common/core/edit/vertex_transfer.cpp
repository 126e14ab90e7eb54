// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/vertex_transfer.h"

#include <limits>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

VertexTransfer::VertexTransfer(const TriangleMesh& mesh, const Adjacency& adjacency, const VertexFinder& finder,
                               const VertexPositions& from)
    : mesh_(mesh), adjacency_(adjacency), from_(from), points_(static_cast<Eigen::Index>(from.points.size()), 3) {
  std::vector<int> rows(from.points.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k] = static_cast<int>(k);
    points_.row(rows[k]) = from.points[k].transpose();
    const std::string what =
        "The edit is applied by position, but the position of its vertex " + std::to_string(from.vertices[k]);
    image_.push_back(keyed("mesh.positions.points", k, [&] {
      return finder.on_surface(from.points[k], what, "take a mesh of the same object").vertex;
    }));
  }
  tree_.emplace(points_, std::move(rows));
}

std::size_t VertexTransfer::row(int vertex) const {
  const int position = index_in(from_.vertices, vertex);
  if (position < 0) {
    throw EditError(ErrorCause::MeshMismatch, "The edit is applied by position, but the position of its vertex " +
                                                  std::to_string(vertex) + " is not among mesh.positions: add it.")
        .at("mesh.positions");
  }
  return static_cast<std::size_t>(position);
}

/// Returns the listed vertex nearest to a vertex of this mesh, if it is in the set.
std::optional<int> VertexTransfer::nearest_member(const std::vector<int>& members, int vertex) const {
  const Vector3 point = mesh_.vertices.row(vertex).transpose();
  const int position = point.allFinite() ? tree_->nearest(point) : -1;
  if (position < 0 || !contains(members, from_.vertices[static_cast<std::size_t>(position)])) {
    return std::nullopt;
  }
  return from_.vertices[static_cast<std::size_t>(position)];
}

std::map<int, int> VertexTransfer::images(const std::vector<int>& set) const {
  std::map<int, int> found;
  std::vector<int> front;
  for (const int v : set) {
    if (found.emplace(image(v), v).second) {
      front.push_back(image(v));
    }
  }
  const std::vector<int> members = sorted_set(set);
  for (auto& [v, member] : found) {  // several members may have the same nearest vertex
    member = nearest_member(members, v).value_or(member);
  }
  // Grows along the surface only, since vertices behind the set are near it as well.
  for (std::size_t k = 0; set.size() > 1 && k < front.size(); ++k) {
    for (const int w : adjacency_.neighbours[front[k]]) {
      const auto member = found.count(w) == 0 ? nearest_member(members, w) : std::nullopt;
      if (member) {
        found.emplace(w, *member);
        front.push_back(w);
      }
    }
  }
  return found;
}

RegionSpec VertexTransfer::images(RegionSpec region) const {
  if (region.kind != RegionSpec::Kind::Vertices) {
    return region;
  }
  const KeptAnchors kept = std::exchange(region.anchors, {});
  check_anchors(kept, std::numeric_limits<int>::max());
  std::map<int, std::size_t> entry;  // indices of the kept anchors
  for (std::size_t k = 0; k < kept.vertices.size(); ++k) {
    entry.emplace(kept.vertices[k], k);
  }
  region.anchors.reach = kept.reach;
  for (const auto& [vertex, member] : images(std::exchange(region.vertices, {}))) {
    region.vertices.push_back(vertex);
    if (const auto at = entry.find(member); at != entry.end()) {
      region.anchors.vertices.push_back(vertex);
      region.anchors.weights.push_back(kept.weights[at->second]);
      region.anchors.depths.push_back(kept.depths[at->second]);
    }
  }
  return region;
}

}  // namespace lapedit
