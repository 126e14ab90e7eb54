// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/positions.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/edit/landmark_space.h"
#include "lapedit/mesh/vertex_finder.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

bool has_query(const EditStep& step) {
  return !step.region_query.empty() || std::any_of(step.handles.begin(), step.handles.end(),
                                                   [](const HandleGroup& group) { return !group.query.empty(); });
}

std::string name_of(const HandleGroup& group, std::size_t number, std::size_t k) {
  return k < group.names.size() ? "Landmark \"" + group.names[k] + "\""
                                : "Point " + std::to_string(k) + " of handle group " + std::to_string(number);
}

/// Positions of a mesh's vertices, applied to another mesh.
class Transfer {
 public:
  Transfer(const TriangleMesh& mesh, const Adjacency& adjacency, const VertexFinder& finder,
           const VertexPositions& from)
      : mesh_(mesh), adjacency_(adjacency), from_(from), points_(static_cast<Eigen::Index>(from.points.size()), 3) {
    std::vector<int> rows(from.points.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      rows[k] = static_cast<int>(k);
      points_.row(rows[k]) = from.points[k].transpose();
      const std::string what =
          "The edit is applied by position, but the position of its vertex " + std::to_string(from.vertices[k]);
      image_.push_back(finder.on_surface(from.points[k], what, "take a mesh of the same object").vertex);
    }
    grid_.emplace(points_, std::move(rows));
  }

  /// Returns the nearest vertex. @throws EditError (MeshMismatch) if the position is not listed
  int image(int vertex) const { return image_[row(vertex)]; }

  /// Returns the vertices that replace a set, ascending, each with the member of the set that it is nearest to.
  std::map<int, int> images(const std::vector<int>& set) const {
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
    if (set.size() > 1) {
      // Grows along the surface only, since vertices behind the set are near it as well.
      for (std::size_t k = 0; k < front.size(); ++k) {
        for (const int w : adjacency_.neighbours[front[k]]) {
          const auto member = found.count(w) == 0 ? nearest_member(members, w) : std::nullopt;
          if (member) {
            found.emplace(w, *member);
            front.push_back(w);
          }
        }
      }
    }
    return found;
  }

 private:
  std::size_t row(int vertex) const {
    const int position = index_in(from_.vertices, vertex);
    if (position < 0) {
      throw EditError(ErrorCause::MeshMismatch, "The edit is applied by position, but the position of its vertex " +
                                                    std::to_string(vertex) + " is not among mesh.positions: add it.");
    }
    return static_cast<std::size_t>(position);
  }

  /// Returns the listed vertex nearest to a vertex of this mesh, if it is in the set.
  std::optional<int> nearest_member(const std::vector<int>& members, int vertex) const {
    if (!mesh_.vertices.row(vertex).allFinite()) {
      return std::nullopt;
    }
    const int position = grid_->nearest(mesh_.vertices.row(vertex).transpose());
    if (position < 0 || !contains(members, from_.vertices[static_cast<std::size_t>(position)])) {
      return std::nullopt;
    }
    return from_.vertices[static_cast<std::size_t>(position)];
  }

  const TriangleMesh& mesh_;
  const Adjacency& adjacency_;
  const VertexPositions& from_;
  Points points_;
  std::vector<int> image_;
  std::optional<VertexGrid> grid_;
};

/// Replaces vertex numbers of the mesh that the edit was made for by numbers of this mesh.
/// @param group  sorted
void transfer(const Transfer& to_here, HandleGroup& group, std::vector<int>& taken) {
  std::vector<int> vertices;
  std::vector<double> weights;
  if (!group.targets.empty()) {
    for (const int v : group.vertices) {
      vertices.push_back(to_here.image(v));
    }
    weights = group.weights;
  } else {
    for (const auto& [vertex, member] : to_here.images(group.vertices)) {
      if (contains(taken, vertex)) {
        continue;  // belongs to an earlier group
      }
      vertices.push_back(vertex);
      if (!group.weights.empty()) {
        weights.push_back(group.weights[static_cast<std::size_t>(index_in(group.vertices, member))]);
      }
    }
  }
  taken = united(taken, sorted_set(vertices));
  group.vertices = std::move(vertices);
  group.weights = std::move(weights);
}

void transfer(const Transfer& to_here, RegionSpec& region) {
  if (region.kind != RegionSpec::Kind::Vertices) {
    return;
  }
  const std::map<int, int> images = to_here.images(region.vertices);
  KeptAnchors anchors;
  std::map<int, std::size_t> entry;  // indices of the kept anchors
  for (std::size_t k = 0; k < region.anchors.vertices.size(); ++k) {
    entry.emplace(region.anchors.vertices[k], k);
  }
  region.vertices.clear();
  for (const auto& [vertex, member] : images) {
    region.vertices.push_back(vertex);
    if (const auto at = entry.find(member); at != entry.end()) {
      anchors.vertices.push_back(vertex);
      anchors.weights.push_back(region.anchors.weights[at->second]);
      anchors.depths.push_back(region.anchors.depths[at->second]);
    }
  }
  anchors.reach = region.anchors.reach;
  region.anchors = std::move(anchors);
}

void check_anchors(const KeptAnchors& anchors) {
  if (anchors.weights.size() != anchors.vertices.size() || anchors.depths.size() != anchors.vertices.size()) {
    throw EditError(ErrorCause::BadParameter, "The region keeps " + std::to_string(anchors.vertices.size()) +
                                                  " anchors with " + std::to_string(anchors.weights.size()) +
                                                  " weights and " + std::to_string(anchors.depths.size()) +
                                                  " depths: give one of each for each anchor.");
  }
}

/// Refuses two landmarks on one vertex, which cannot both be met.
void refuse_doubles(const HandleGroup& group, std::size_t number) {
  std::map<int, std::size_t> first;
  for (std::size_t k = 0; k < group.vertices.size(); ++k) {
    const auto [found, is_new] = first.emplace(group.vertices[k], k);
    if (!is_new) {
      throw EditError(ErrorCause::BadParameter, name_of(group, number, found->second) + " and " +
                                                    name_of(group, number, k) + " are both nearest to vertex " +
                                                    std::to_string(group.vertices[k]) +
                                                    ": keep one of them, or use a finer mesh.");
    }
  }
}

std::vector<int> selected(const std::vector<int>& first, const std::vector<int>& second, const char* what) {
  if (first.empty() && second.empty()) {
    throw EditError(ErrorCause::NoHandle,
                    "No vertex and no face is selected, but " + std::string(what) +
                        " is the selection: select vertices or faces, or save the mesh with its selection.");
  }
  return first.empty() ? second : first;
}

std::vector<int> within(const TriangleMesh& mesh, const Adjacency& adjacency, const VertexFinder& finder,
                        const VertexQuery::Disc& disc, const std::string& what) {
  return vertices_within(mesh, adjacency, finder.on_surface(disc.point, what).vertex, disc.radius);
}

constexpr double kTargetsFar = 5, kTargetsNear = 0.5;  // distances from the surface, over its diagonal

void locate(const TriangleMesh& mesh, const Adjacency& adjacency, const VertexFinder& finder,
            const SelectedVertices& selection, HandleGroup& group, std::size_t number) {
  const std::string name = "handle group " + std::to_string(number);
  if (group.query.within) {
    group.vertices = within(mesh, adjacency, finder, *group.query.within, "The point of " + name);
  } else if (group.query.selected) {
    group.vertices = selected(selection.vertices, selection.of_faces, name.c_str());
  }
  const std::vector<Vector3>& points = group.query.points;
  const auto is_far = [&finder](double most) {
    return [&finder, most](const Vector3& point) { return !finder.is_near(point, most); };
  };
  std::string advice = "give a point on the surface";
  if (std::any_of(points.begin(), points.end(), is_far(VertexFinder::kFar))) {
    const std::string mistake = likely_mistake(finder, points, group.spaces.points, VertexFinder::kFar);
    advice = mistake.empty() ? advice : mistake;
  }
  if (!points.empty() && std::all_of(group.targets.begin(), group.targets.end(), is_far(kTargetsFar))) {
    group.targets_advice =
        likely_mistake(finder, group.targets, group.spaces.targets, kTargetsNear, extent_of(points) / 2);
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector3& point = points[k];
    const int vertex = finder.on_surface(point, name_of(group, number, k), advice).vertex;
    group.vertices.push_back(vertex);
    if (const Vector3 position = mesh.vertices.row(vertex).transpose(); k < group.targets.size() && position != point) {
      group.targets[k] += position - point;
    }
  }
  if (!group.query.points.empty() && !group.targets.empty()) {
    refuse_doubles(group, number);
  }
  group.query = VertexQuery();
}

}  // namespace

Edit located(const TriangleMesh& mesh, const Adjacency& adjacency, Edit edit, const SelectedVertices& selection) {
  if (!edit.by_position() && std::none_of(edit.steps.begin(), edit.steps.end(), has_query)) {
    return edit;
  }
  const VertexFinder finder(mesh);
  std::optional<Transfer> to_here;
  if (edit.by_position()) {
    to_here.emplace(mesh, adjacency, finder, edit.positions);
  }
  for (EditStep& step : edit.steps) {
    if (!step.region_query.empty()) {
      step.region.vertices = step.region_query.within
                                 ? within(mesh, adjacency, finder, *step.region_query.within, "The region's point")
                                 : selected(selection.of_faces, selection.vertices, "the region");
      step.region_query = VertexQuery();
    } else if (to_here) {
      check_anchors(step.region.anchors);
      transfer(*to_here, step.region);
    }
    std::vector<int> taken;
    for (std::size_t g = 0; g < step.handles.size(); ++g) {
      HandleGroup& group = step.handles[g];
      if (!group.query.empty()) {
        locate(mesh, adjacency, finder, selection, group, g);
      } else if (to_here) {
        sort_group(group, g);
        transfer(*to_here, group, taken);
      }
    }
  }
  edit.positions = VertexPositions();
  return edit;
}

Edit with_positions(const TriangleMesh& mesh, const Adjacency& adjacency, Edit edit) {
  constexpr std::size_t kMost = 200000;
  std::vector<int> named;
  const auto sound = [&mesh](std::vector<int> vertices) {
    for (const int v : vertices) {
      require_vertex("Vertex", v, mesh.vertices.rows());
    }
    return sorted_set(std::move(vertices));
  };
  for (const EditStep& step : edit.steps) {
    named = united(named, grown(adjacency, sound(step.region.vertices)));
    for (const HandleGroup& group : step.handles) {
      const std::vector<int> set = sound(group.vertices);
      named = united(named, set.size() > 1 && group.targets.empty() ? grown(adjacency, set) : set);
    }
  }
  edit.positions = VertexPositions();
  if (named.size() > kMost) {
    return edit;
  }
  for (const int v : named) {
    Vector3 position = mesh.vertices.row(v).transpose();
    for (double& number : position) {  // single precision is enough, and the text is half as long
      char text[32];
      std::snprintf(text, sizeof text, "%.9g", number);
      number = std::strtod(text, nullptr);
    }
    if (position.allFinite()) {
      edit.positions.vertices.push_back(v);
      edit.positions.points.push_back(position);
    }
  }
  return edit;
}

}  // namespace lapedit
