// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/positions.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "lapedit/base/refuse.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/vertex_tree.h"

namespace lapedit {
namespace {

/// Finds the vertices of another mesh that replace those of the mesh that an edit was made for.
class VertexTransfer {
 public:
  /// All arguments but the finder must outlive the object. O(positions log positions)
  /// @throws EditError as VertexFinder::on_surface()
  VertexTransfer(const TriangleMesh& mesh, const Adjacency& adjacency, const VertexFinder& finder,
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

  /// Returns the nearest vertex. @throws EditError (MeshMismatch) if the position is not listed
  int image(int vertex) const { return image_[row(vertex)]; }
  /// Returns the vertices that replace a set, ascending, each with the member of the set that it is nearest to: of each
  /// member the nearest vertex, and those around that are nearer to a member than to any other listed vertex.
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

  /// Replaces a set.
  void replace(std::vector<int>& set) const {
    for (const auto& [vertex, member] : images(std::exchange(set, {}))) {
      set.push_back(vertex);
    }
  }

  /// Returns a region with its vertex sets and kept anchors replaced. @param given  whether it lists its vertices
  /// @param mirrored  whether its mirror image is added
  /// @throws EditError (BadParameter)
  RegionSpec images(RegionSpec region, bool given, bool mirrored) const {
    if (!given || region.kind != RegionSpec::Kind::Vertices) {
      replace(region.held);
      return region;
    }
    // Others have no effect unless they are in the mirror image, and older files have no positions for them.
    std::vector<int> effective = sorted_set(region.vertices);
    effective = mirrored ? united(effective, from_.vertices) : effective;
    region.held = common(sorted_set(std::move(region.held)), effective);
    replace(region.held);
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
        region.anchors.add(vertex, kept.weights[at->second], kept.depths[at->second]);
      }
    }
    return region;
  }

 private:
  std::size_t row(int vertex) const {
    const int position = index_in(from_.vertices, vertex);
    if (position < 0) {
      refuse_edit(ErrorCause::MeshMismatch, {"mesh.positions"},
                  "The edit is applied by position, but the position of its vertex ", vertex,
                  " is not among mesh.positions: add it.");
    }
    return static_cast<std::size_t>(position);
  }

  /// Returns the listed vertex nearest to a vertex of this mesh, if it is in the set.
  std::optional<int> nearest_member(const std::vector<int>& members, int vertex) const {
    const Vector3 point = mesh_.vertices.row(vertex).transpose();
    const int position = point.allFinite() ? tree_->nearest(point) : -1;
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
  std::optional<VertexTree> tree_;
};

bool has_query(const EditStep& step) {
  return !step.region_query.empty() || std::any_of(step.handles.begin(), step.handles.end(),
                                                   [](const HandleGroup& group) { return !group.query.empty(); });
}

std::string name_of(const HandleGroup& group, std::size_t number, std::size_t k) {
  return k < group.names.size() ? "Landmark \"" + group.names[k] + "\""
                                : "Point " + std::to_string(k) + " of handle group " + std::to_string(number);
}

/// Returns the key of a point or landmark. Points with targets have the names of their keys.
std::string key_of(const HandleGroup& group, std::size_t k) {
  const bool is_landmark = k < group.names.size() && group.names[k].find("].points[") == std::string::npos;
  return is_landmark ? "landmarks" : "points[" + std::to_string(k) + "]";
}

/// Replaces vertex numbers of the mesh that the edit was made for by numbers of this mesh.
/// @param group  sorted
void transfer(const VertexTransfer& to_here, HandleGroup& group, std::vector<int>& taken) {
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

/// Refuses two landmarks on one vertex, which cannot both be met.
void refuse_doubles(const HandleGroup& group, std::size_t number) {
  std::map<int, std::size_t> first;
  for (std::size_t k = 0; k < group.vertices.size(); ++k) {
    const auto [found, is_new] = first.emplace(group.vertices[k], k);
    if (!is_new) {
      refuse_edit(ErrorCause::BadParameter, {key_of(group, k), group.vertices[k]},
                  name_of(group, number, found->second), " and ", name_of(group, number, k),
                  " are both nearest to vertex ", group.vertices[k], ": keep one of them, or use a finer mesh.");
    }
  }
}

std::vector<int> selected(const std::vector<int>& first, const std::vector<int>& second, const char* what) {
  if (first.empty() && second.empty()) {
    refuse_edit(ErrorCause::NoHandle, {"selected"}, "No vertex and no face is selected, but ", what,
                " is the selection: select vertices or faces, or save the mesh with its selection.");
  }
  return first.empty() ? second : first;
}

std::vector<int> within(const TriangleMesh& mesh, const Adjacency& adjacency, const VertexFinder& finder,
                        const VertexQuery::Disc& disc, const std::string& what) {
  return keyed("within", [&] {
    const int vertex = keyed("point", [&] { return finder.on_surface(disc.point, what).vertex; });
    return vertices_within(mesh, adjacency, vertex, disc.radius);
  });
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
    const int vertex =
        keyed(key_of(group, k), [&] { return finder.on_surface(point, name_of(group, number, k), advice).vertex; });
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

void convert_group(HandleGroup& group, const std::string& mesh_space) {
  LandmarkSpaces& spaces = group.spaces;
  const std::string& space = mesh_space.empty() ? spaces.points : mesh_space;
  const bool has_points = convert(group.query.points, spaces.points, space);
  const bool has_targets = convert(group.targets, spaces.targets, space);
  if (has_points || has_targets) {
    spaces.conversion = (has_points && has_targets ? ""
                         : has_points              ? "points "
                                                   : "targets ") +
                        std::string("from ") + (has_points ? spaces.points : spaces.targets) + " to " + space;
  }
  spaces.points = has_points ? space : spaces.points;
  spaces.targets = has_targets ? space : spaces.targets;
}

/// Finds the vertices of the steps.
void locate_steps(const TriangleMesh& mesh, const Adjacency& adjacency, const SelectedVertices& selection, Edit& edit) {
  const VertexFinder finder(mesh);
  std::optional<VertexTransfer> to_here;
  if (edit.by_position()) {
    to_here.emplace(mesh, adjacency, finder, edit.positions);
  }
  for (std::size_t s = 0; s < edit.steps.size(); ++s) {
    EditStep& step = edit.steps[s];
    const std::string key = entry_key("steps", s) + ".";
    if (to_here) {
      step.region = to_here->images(std::move(step.region), step.region_query.empty(), step.mirror.has_value());
    }
    if (to_here && step.fit) {
      to_here->replace(step.fit->exclude);
    }
    if (!step.region_query.empty()) {
      step.region.vertices = keyed(key + "region", [&] {
        return step.region_query.within
                   ? within(mesh, adjacency, finder, *step.region_query.within, "The region's point")
                   : selected(selection.of_faces, selection.vertices, "the region");
      });
      step.region_query = VertexQuery();
    }
    std::vector<int> taken;
    for (std::size_t g = 0; g < step.handles.size(); ++g) {
      HandleGroup& group = step.handles[g];
      if (!group.query.empty()) {
        keyed(key + "handles", g, [&] { locate(mesh, adjacency, finder, selection, group, g); });
      } else if (to_here) {
        sort_group(group, g);
        transfer(*to_here, group, taken);
      }
    }
  }
}

}  // namespace

Edit in_space(Edit edit, const std::string& mesh_space) {
  require_known_space(mesh_space);
  for (std::size_t k = 0; k < edit.steps.size(); ++k) {
    std::vector<HandleGroup>& groups = edit.steps[k].handles;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      keyed("steps", k, [&] { keyed("handles", g, [&] { convert_group(groups[g], mesh_space); }); });
    }
  }
  return edit;
}

Edit located(const TriangleMesh& mesh, const Adjacency& adjacency, Edit edit, const SelectedVertices& selection) {
  if (!edit.by_position() && std::none_of(edit.steps.begin(), edit.steps.end(), has_query)) {
    return edit;
  }
  if (const auto joined = joined_surface(mesh); joined != nullptr) {
    locate_steps({mesh.vertices, joined->faces}, joined->adjacency, selection, edit);
  } else {
    locate_steps(mesh, adjacency, selection, edit);
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
  const auto add = [&named](const std::vector<int>& set) { named.insert(named.end(), set.begin(), set.end()); };
  for (const EditStep& step : edit.steps) {
    add(grown(adjacency, sound(step.region.vertices)));
    add(grown(adjacency, sound(step.region.held)));
    add(grown(adjacency, sound(step.fit ? step.fit->exclude : std::vector<int>())));
    for (const HandleGroup& group : step.handles) {
      const std::vector<int> set = sound(group.vertices);
      add(set.size() > 1 && group.targets.empty() ? grown(adjacency, set) : set);
    }
  }
  named = sorted_set(std::move(named));
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
