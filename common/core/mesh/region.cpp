// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/region.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "lapedit/base/format_text.h"
#include "lapedit/base/refuse.h"
#include "lapedit/mesh/connect.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

bool is_finite(const Points& points, int vertex) {
  return points.row(vertex).allFinite();
}

std::string key_of(std::size_t group, const char* key) {
  return entry_key("handles", group) + "." + key;
}

void check_weights(const std::vector<std::vector<int>>& groups, const std::vector<std::vector<double>>& weights) {
  for (std::size_t g = 0; g < weights.size(); ++g) {
    for (std::size_t k = 0; k < weights[g].size(); ++k) {
      if (!(weights[g][k] >= kLeastWeight && weights[g][k] <= 1)) {
        refuse_edit(ErrorCause::BadParameter, {key_of(g, "weights"), groups[g][k]}, "Handle vertex ", groups[g][k],
                    " has the weight ", weights[g][k], ": weights of handle vertices go from 0.000001 to 1.");
      }
    }
  }
}

void check_spec(const RegionSpec& spec) {
  if (!(spec.padding >= 0 && spec.padding <= 1)) {
    refuse_edit(ErrorCause::BadParameter, {"region.padding"}, "The padding is ", spec.padding,
                ": give a fraction of the region's radius from 0 to 1.");
  }
  if (spec.kind == RegionSpec::Kind::Radius && !(spec.radius > 0 && std::isfinite(spec.radius))) {
    refuse_edit(ErrorCause::BadParameter, {"region.radius"}, "The region's radius is ", spec.radius,
                ": give a finite length greater than 0.");
  }
}

/// Finds a region step by step; build() names the steps.
class RegionBuilder {
 public:
  using Groups = std::vector<std::vector<int>>;
  using Weights = std::vector<std::vector<double>>;

  /// All arguments have to outlive the object.
  RegionBuilder(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec, const Groups& groups,
                int threads)
      : mesh_(mesh),
        adjacency_(adjacency),
        spec_(spec),
        groups_(groups),
        is_set_(spec.kind == RegionSpec::Kind::Vertices),
        pool_(mesh.vertices.rows() >= Eigen::Index{4} * kGrain ? threads : 1) {
    region_.kind = spec.kind;
    region_.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  }

  Region build(const Weights& weights);
  Region paint();
  /// Returns flags of the vertices whose links count: those of a given set, or those near enough to be part of a region
  /// of a radius, to be linked to its vertices, to compete for these links, or to be what competitors are linked to
  /// instead.
  std::vector<char> linkable();

 private:
  static constexpr int kGrain = 4096;

  void collect_handles();
  void flag_set();
  void measure_distances();
  void require_finite(const std::vector<int>& vertices) const;
  [[noreturn]] void refuse_handle_only() const;
  void extract_graph();
  void extract_faces();
  void place_anchor_band();
  void classify();
  void find_components();
  void take_weights(const Weights& weights);

  const TriangleMesh& mesh_;
  const Adjacency& adjacency_;
  const RegionSpec& spec_;
  const Groups& groups_;
  const bool is_set_;
  ThreadPool pool_;
  std::vector<int> handles_, group_of_;  // handle vertices of the mesh, ascending; group of each mesh vertex, -1: none
  std::vector<char> flags_;              // of a given set, per mesh vertex
  std::vector<int> local_;               // mesh vertex -> local vertex, or -1
  std::vector<char> boundary_;           // per local vertex: whether it has a mesh neighbour outside
  Attached attached_;
  Region region_;
};

/// Finds all handle vertices and the group of each mesh vertex.
void RegionBuilder::collect_handles() {
  const int n = region_.mesh_vertices;
  if (groups_.empty() && !(is_set_ && spec_.without_handle)) {
    refuse_edit(ErrorCause::NoHandle, {"handles"}, "There is no handle: name at least one vertex to move.");
  }
  group_of_.assign(n, -1);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (groups_[g].empty()) {
      refuse_edit(ErrorCause::NoHandle, {key_of(g, "vertices")}, "Handle group ", g,
                  " has no vertices: name at least one vertex to move.");
    }
    for (const int v : groups_[g]) {
      keyed("handles", g, [&] { require_vertex("Handle vertex", v, n); });
      if (group_of_[v] >= 0 && group_of_[v] != static_cast<int>(g)) {
        refuse_edit(ErrorCause::BadIndex, {key_of(g, "vertices"), v}, "Vertex ", v, " is in handle groups ",
                    group_of_[v], " and ", g, ": it can follow only one of them.");
      }
      if (!is_finite(mesh_.vertices, v)) {
        refuse_edit(ErrorCause::NotFinite, {key_of(g, "vertices"), v}, "Handle vertex ", v,
                    " has a coordinate that is not a number: repair the mesh first.");
      }
      if (group_of_[v] < 0) {
        group_of_[v] = static_cast<int>(g);
        handles_.push_back(v);
      }
    }
  }
  std::sort(handles_.begin(), handles_.end());
}

/// Marks the vertices of the given set. Throws unless the handles are among them.
void RegionBuilder::flag_set() {
  if (spec_.vertices.empty()) {
    refuse_edit(ErrorCause::EmptyRegion, {"region.vertices"},
                "The region has no vertices: select the part of the surface to edit.");
  }
  flags_.assign(region_.mesh_vertices, 0);
  for (const int v : spec_.vertices) {
    require_vertex("Region vertex", v, region_.mesh_vertices, "region.vertices");
    flags_[v] = 1;
  }
  const auto outside = [this](int v) { return !flags_[v]; };
  const auto count = std::count_if(handles_.begin(), handles_.end(), outside);
  if (count > 0) {
    const int first = *std::find_if(handles_.begin(), handles_.end(), outside);
    refuse_edit(ErrorCause::HandleOutsideRegion, {"region", first}, count, " of ", handles_.size(),
                " handle vertices lie outside the region, the first is vertex ", first,
                ": enlarge the region or choose a handle inside it.");
  }
}

/// Finds the region's vertices, in the order of the mesh, with their distances from the handles, or without a handle
/// from the boundary of the set.
void RegionBuilder::measure_distances() {
  const auto has_neighbour_outside = [this](int v) {
    const CompressedRows::Row ring = adjacency_.neighbours[v];
    return std::any_of(ring.begin(), ring.end(), [this](int w) { return !flags_[w]; });
  };
  std::vector<int> seeds = handles_;
  for (int v = 0; handles_.empty() && v < region_.mesh_vertices; ++v) {
    if (flags_[v] && has_neighbour_outside(v)) {
      seeds.push_back(v);
    }
  }
  const double cutoff = spec_.kind == RegionSpec::Kind::Radius ? rounded_up(spec_.radius) : kUnreached;
  const DistanceField field({mesh_, adjacency_}, seeds, cutoff, is_set_ ? &flags_ : nullptr, pool_);
  local_.assign(region_.mesh_vertices, -1);
  const auto number = [this](const auto& distance) {
    for (int v = 0; v < region_.mesh_vertices; ++v) {
      if (distance[v] < kUnreached) {
        local_[v] = region_.size();
        region_.mesh_vertex.push_back(v);
        region_.distance.push_back(distance[v]);
      }
    }
  };
  if (spec_.tips || spec_.pieces) {
    std::vector<double> distance(region_.mesh_vertices);
    for (int v = 0; v < region_.mesh_vertices; ++v) {
      distance[v] = field[v];
    }
    attached_ = attached_to(mesh_, adjacency_, spec_, std::move(distance), flags_);
    number(attached_.distance);
  } else {
    number(field);
  }
  region_.pieces = attached_.pieces;
  if (!handles_.empty()) {
    return;
  }
  region_.without_handle = true;
  if (region_.size() == 0) {
    refuse_edit(ErrorCause::NothingToFollow, {"region"},
                "The region is a whole piece of the surface, so no vertex around it stays: choose a smaller region, "
                "or give a handle.");
  }
  const double largest = *std::max_element(region_.distance.begin(), region_.distance.end());
  for (double& distance : region_.distance) {
    distance = largest - distance;
  }
}

/// Throws EditError if a vertex of a given set, or else in or next to the region, has non-finite coordinates, since its
/// distance is unknown. @param vertices  the set or the region, any order
void RegionBuilder::require_finite(const std::vector<int>& vertices) const {
  std::vector<int> bad;
  const auto look_at = [&](int v) {
    if (!is_finite(mesh_.vertices, v)) {
      bad.push_back(v);
    }
  };
  for (const int v : vertices) {
    look_at(v);
    if (!is_set_) {
      const CompressedRows::Row ring = adjacency_.neighbours[v];
      std::for_each(ring.begin(), ring.end(), look_at);
    }
  }
  bad = sorted_set(std::move(bad));
  if (!bad.empty()) {
    refuse_edit(ErrorCause::NotFinite, {"region", bad[0]}, bad.size(), (bad.size() == 1 ? " vertex" : " vertices"),
                " in or next to the region have a coordinate that is not a number, the first is vertex ", bad[0],
                ": repair the mesh or choose a region without them.");
  }
}

void RegionBuilder::refuse_handle_only() const {
  std::string sentence = "The region is the handle alone (" + std::to_string(handles_.size()) +
                         (handles_.size() == 1 ? " vertex" : " vertices") + "), so nothing would follow it: ";
  double shortest = kUnreached;
  for (const int v : handles_) {
    for (const int w : adjacency_.neighbours[v]) {
      if (!contains(handles_, w)) {
        shortest = std::min(shortest, (mesh_.vertices.row(w) - mesh_.vertices.row(v)).norm());
      }
    }
  }
  if (spec_.kind == RegionSpec::Kind::Radius && std::isfinite(shortest)) {
    sentence += "give a radius above " + number_text(shortest) + ", the handle's shortest edge, instead of " +
                number_text(spec_.radius) + ".";
  } else if (std::isfinite(shortest)) {
    sentence += "enlarge the region beyond the handle.";
  } else {
    sentence += "choose a handle that is a part of a connected surface, not all of it.";
  }
  refuse_edit(ErrorCause::NothingToFollow, {}, sentence);
}

/// Makes the region's graph and finds its boundary.
void RegionBuilder::extract_graph() {
  const CompressedRows linked =
      attached_.links.empty() ? CompressedRows() : with_edges(adjacency_.neighbours, attached_.links);
  const CompressedRows& neighbours = attached_.links.empty() ? adjacency_.neighbours : linked;
  std::vector<int>&offsets = region_.neighbours.offsets, &values = region_.neighbours.values;
  std::size_t most = 0;
  for (const int v : region_.mesh_vertex) {
    most += static_cast<std::size_t>(neighbours[v].size());
  }
  offsets.reserve(region_.mesh_vertex.size() + 1);
  values.reserve(most);
  boundary_.reserve(region_.mesh_vertex.size());
  bool finite = true;
  Checkpoints checkpoints;
  for (const int v : region_.mesh_vertex) {
    checkpoints();
    bool is_boundary = false;
    for (const int w : neighbours[v]) {
      if (local_[w] >= 0) {
        values.push_back(local_[w]);
      } else {
        is_boundary = true;
        finite = finite && is_finite(mesh_.vertices, w);
      }
    }
    boundary_.push_back(is_boundary ? 1 : 0);
    offsets.push_back(static_cast<int>(values.size()));
  }
  if (!finite && !is_set_) {
    require_finite(region_.mesh_vertex);
  }
}

/// Finds the faces that touch a region edge, and those inside, to which it gives one orientation.
void RegionBuilder::extract_faces() {
  // A pass over all faces is faster than collecting and sorting, unless the mesh has many more faces than the region.
  constexpr Eigen::Index kMany = 32;
  std::vector<int>& faces = region_.edge_faces;
  const auto corners_inside = [this](int f) {
    return (local_[mesh_.faces(f, 0)] >= 0) + (local_[mesh_.faces(f, 1)] >= 0) + (local_[mesh_.faces(f, 2)] >= 0);
  };
  Eigen::Index inside = 0;
  Checkpoints checkpoints;
  if (mesh_.faces.rows() > kMany * region_.size()) {
    for (const int v : region_.mesh_vertex) {
      const CompressedRows::Row around = adjacency_.faces[v];
      std::copy_if(around.begin(), around.end(), std::back_inserter(faces),
                   [&](int f) { return corners_inside(f) >= 2; });
    }
    faces = sorted_set(std::move(faces));
    inside = std::count_if(faces.begin(), faces.end(), [&](int f) { return corners_inside(f) == 3; });
  } else {
    for (int f = 0; f < static_cast<int>(mesh_.faces.rows()); ++f) {
      checkpoints();
      const int corners = corners_inside(f);
      inside += corners == 3 ? 1 : 0;
      if (corners >= 2) {
        faces.push_back(f);
      }
    }
  }
  region_.faces.resize(inside, 3);
  Eigen::Index row = 0;
  for (const int f : faces) {
    if (corners_inside(f) == 3) {
      region_.faces.row(row++) << local_[mesh_.faces(f, 0)], local_[mesh_.faces(f, 1)], local_[mesh_.faces(f, 2)];
    }
  }
  if (!adjacency_.oriented) {
    const std::vector<char> flips = flips_of(paired_sides(region_.size(), region_.faces), region_.faces);
    for (Eigen::Index f = 0; f < inside; ++f) {
      if (flips[static_cast<std::size_t>(f)] != 0) {
        region_.faces.row(f).reverseInPlace();
      }
    }
  }
}

/// Computes anchor_depth, the depth of each vertex in the anchor band (0 or less outside it, 1 at its far end), and
/// anchor_weight, the weight of kept anchors (-1 for all others). With d the distance from the handle, b that from the
/// boundary, p the padding, r the radius and d_max the largest d:
///     grown by a radius:  (d - (1 - p) r) / (p r)
///     a given set:        1 - b / (p d_max)
///     kept anchors:       as given
void RegionBuilder::place_anchor_band() {
  std::vector<double>& depth = region_.anchor_depth;
  if (is_set_ && !spec_.anchors.empty()) {
    for (std::size_t k = 0; k < spec_.anchors.vertices.size(); ++k) {
      if (const int i = local_[spec_.anchors.vertices[k]]; i >= 0) {
        depth[i] = spec_.anchors.depths[k];
        region_.anchor_weight[i] = spec_.anchors.weights[k];
      }
    }
  } else if (is_set_) {
    const double width = spec_.padding * region_.max_distance;
    std::vector<int> seeds;
    std::vector<char> inside(region_.mesh_vertices, 0);
    for (int i = 0; i < region_.size(); ++i) {
      inside[region_.mesh_vertex[i]] = 1;
      if (boundary_[i]) {
        seeds.push_back(region_.mesh_vertex[i]);
      }
    }
    const DistanceField from_boundary({mesh_, adjacency_}, seeds, width, &inside, pool_);
    for (int i = 0; width > 0 && i < region_.size(); ++i) {
      depth[i] = 1 - from_boundary[region_.mesh_vertex[i]] / width;
    }
  } else if (spec_.kind == RegionSpec::Kind::Radius && spec_.padding > 0) {
    for (int i = 0; i < region_.size(); ++i) {
      depth[i] = (region_.distance[i] - (1 - spec_.padding) * spec_.radius) / (spec_.padding * spec_.radius);
    }
  }
  for (int i = 0; !attached_.is_free.empty() && i < region_.size(); ++i) {
    depth[i] = attached_.is_free[region_.mesh_vertex[i]] ? 0 : depth[i];
  }
  for (const int v : spec_.held) {
    if (const int i = local_[v]; i >= 0) {
      depth[i] = region_.anchor_weight[i] = 1;
    }
  }
}

/// Classifies vertices as handle, anchor or free. An anchor's weight is d / d_max, so that anchors near the handle are
/// weak.
void RegionBuilder::classify() {
  const int n = region_.size();
  region_.classes.assign(n, VertexClass::Free);
  region_.group.assign(n, -1);
  region_.anchor_weight.assign(n, -1);
  region_.anchor_depth.assign(n, 0);
  place_anchor_band();
  for (int i = 0; i < n; ++i) {
    double& depth = region_.anchor_depth[i];
    double& weight = region_.anchor_weight[i];
    const bool kept = weight >= 0;
    if (boundary_[i] || depth > kRoundedLength || kept) {
      region_.classes[i] = VertexClass::Anchor;
      depth = boundary_[i] ? 1 : std::min(depth, 1.0);
      weight = kept ? weight : region_.max_distance > 0 ? std::min(1.0, region_.distance[i] / region_.max_distance) : 1;
    } else {
      depth = weight = 0;
    }
  }
  for (const int v : handles_) {
    const int i = local_[v];
    region_.classes[i] = VertexClass::Handle;
    region_.group[i] = group_of_[v];
    region_.anchor_depth[i] = region_.anchor_weight[i] = 0;
  }
}

/// Stores weights unless all are 1. A vertex that is listed twice gets the larger weight.
void RegionBuilder::take_weights(const Weights& weights) {
  const auto is_soft = [](const auto& group) {
    return std::any_of(group.begin(), group.end(), [](double weight) { return weight < 1; });
  };
  if (std::none_of(weights.begin(), weights.end(), is_soft)) {
    return;
  }
  region_.handle_weight.assign(region_.mesh_vertex.size(), 0);
  for (std::size_t g = 0; g < weights.size(); ++g) {
    for (std::size_t k = 0; k < weights[g].size(); ++k) {
      double& weight = region_.handle_weight[local_[groups_[g][k]]];
      weight = std::max(weight, weights[g][k]);
    }
  }
  for (double& weight : region_.handle_weight) {
    weight = weight > 0 ? weight : 1;
  }
}

void RegionBuilder::find_components() {
  region_.anchored.assign(connected_components(region_.neighbours, region_.component), 0);
  for (int i = 0; i < region_.size(); ++i) {
    region_.anchored[region_.component[i]] |= region_.classes[i] == VertexClass::Anchor;
  }
}

std::vector<char> RegionBuilder::linkable() {
  const int n = region_.mesh_vertices;
  const bool near = spec_.kind == RegionSpec::Kind::Radius && !spec_.tips && !spec_.pieces;
  std::vector<char> flags(n, !near && !is_set_);
  if (is_set_) {
    for (const int v : spec_.vertices) {
      if (v >= 0 && v < n) {
        flags[v] = 1;
      }
    }
  } else if (near) {
    collect_handles();
    const Eigen::AlignedBox3d box = bounding_box(mesh_.vertices, handles_);
    const Vector3 margin = Vector3::Constant(rounded_up(spec_.radius + 3 * spec_.connect_gap));
    const Eigen::AlignedBox3d reach(box.min() - margin, box.max() + margin);
    for (int v = 0; v < n; ++v) {
      flags[v] = reach.contains(Vector3(mesh_.vertices.row(v)));
    }
  }
  return flags;
}

/// Lists the edges of the region's graph that the mesh does not have.
void find_links(const Adjacency& adjacency, Region& region) {
  region.links.clear();
  Checkpoints checkpoints;
  for (int i = 0; i < region.size(); ++i) {
    checkpoints();
    const CompressedRows::Row ring = adjacency.neighbours[region.mesh_vertex[i]];
    for (const int j : region.neighbours[i]) {
      if (i < j && !std::binary_search(ring.begin(), ring.end(), region.mesh_vertex[j])) {
        region.links.emplace_back(i, j);
      }
    }
  }
}

Region RegionBuilder::build(const Weights& weights) {
  collect_handles();
  check_weights(groups_, weights);
  if (is_set_) {
    flag_set();
    check_anchors(spec_.anchors, region_.mesh_vertices);
  }
  measure_distances();
  if (is_set_) {
    require_finite(spec_.vertices);
    region_.left_out = static_cast<int>(std::count(flags_.begin(), flags_.end(), 1)) - region_.size();
  }
  if (!handles_.empty() && region_.size() == static_cast<int>(handles_.size())) {
    require_finite(region_.mesh_vertex);
    refuse_handle_only();
  }
  region_.max_distance = is_set_ && !spec_.anchors.empty()
                             ? spec_.anchors.reach
                             : *std::max_element(region_.distance.begin(), region_.distance.end());
  region_.radius = spec_.kind == RegionSpec::Kind::Radius ? spec_.radius : region_.max_distance;
  extract_graph();
  if (!attached_.links.empty()) {
    find_links(adjacency_, region_);
  }
  extract_faces();
  classify();
  find_components();
  take_weights(weights);
  return std::move(region_);
}

Region RegionBuilder::paint() {
  region_.mesh_vertex = spec_.vertices;
  local_.assign(region_.mesh_vertices, -1);
  for (int i = 0; i < region_.size(); ++i) {
    local_[region_.mesh_vertex[i]] = i;
  }
  extract_graph();
  extract_faces();
  for (const char is_boundary : boundary_) {
    region_.classes.push_back(is_boundary != 0 ? VertexClass::Anchor : VertexClass::Free);
  }
  for (const std::vector<int>& group : groups_) {
    for (const int v : group) {
      if (local_[v] >= 0) {
        region_.classes[local_[v]] = VertexClass::Handle;
      }
    }
  }
  return std::move(region_);
}

}  // namespace

int Region::count(VertexClass c) const {
  return static_cast<int>(std::count(classes.begin(), classes.end(), c));
}

Region build_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                    const std::vector<std::vector<int>>& groups, int threads,
                    const std::vector<std::vector<double>>& weights) {
  check_spec(spec);
  for (const int v : spec.held) {
    require_vertex("Held vertex", v, mesh.vertices.rows(), "region.held");
  }
  if (spec.connect_gap == 0) {
    return RegionBuilder(mesh, adjacency, spec, groups, threads).build(weights);
  }
  // Links that leave a given set make no boundary, since vertices outside the set do not constrain it.
  const std::vector<char> flags = RegionBuilder(mesh, adjacency, spec, groups, 1).linkable();
  const Adjacency linked{linked_neighbours(mesh, adjacency.neighbours, spec.connect_gap, &flags), adjacency.faces};
  Region region = RegionBuilder(mesh, linked, spec, groups, threads).build(weights);
  find_links(adjacency, region);
  return region;
}

std::vector<double> falloff_weights(const std::vector<double>& distances, double disc_radius) {
  constexpr double kBoundary = 0.3;
  const double boundary = std::max(kLeastWeight, kBoundary / std::max(1.0, static_cast<double>(distances.size())));
  std::vector<double> weights;
  weights.reserve(distances.size());
  for (const double distance : distances) {
    weights.push_back(std::pow(boundary, smooth_step(std::clamp(distance / disc_radius, 0.0, 1.0))));
  }
  return weights;
}

std::vector<int> lone_vertices(const Region& region) {
  constexpr int kNone = -2;
  std::vector<int> lone(1 + *std::max_element(region.group.begin(), region.group.end()), kNone);
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      lone[region.group[i]] = lone[region.group[i]] == kNone ? i : -1;
    }
  }
  return lone;
}

std::vector<double> largest_weights(const Region& region) {
  std::vector<double> largest(1 + *std::max_element(region.group.begin(), region.group.end()), 0);
  for (int i = 0; i < region.size(); ++i) {
    if (region.group[i] >= 0) {
      largest[region.group[i]] = std::max(largest[region.group[i]], region.weight(i));
    }
  }
  return largest;
}

void check_anchors(const KeptAnchors& anchors, int mesh_vertices) {
  const std::size_t count = anchors.vertices.size();
  if (anchors.weights.size() != count || anchors.depths.size() != count) {
    refuse_edit(ErrorCause::BadParameter, {"region.anchors"}, count, " kept anchors have ", anchors.weights.size(),
                " weights and ", anchors.depths.size(), " depths: give one of each for each anchor.");
  }
  if (count > 0 && !(anchors.reach > 0 && std::isfinite(anchors.reach))) {
    refuse_edit(ErrorCause::BadParameter, {"region.anchors.reach"}, "The reach of the kept anchors is ", anchors.reach,
                ": give the largest handle distance that they were made with.");
  }
  for (std::size_t i = 0; i < count; ++i) {
    require_vertex("Kept anchor", anchors.vertices[i], mesh_vertices, "region.anchors.vertices");
    if (!(anchors.weights[i] >= 0 && anchors.weights[i] <= 1 && anchors.depths[i] >= 0 && anchors.depths[i] <= 1)) {
      refuse_edit(ErrorCause::BadParameter, {"region.anchors"}, "Kept anchor ", anchors.vertices[i], " has the weight ",
                  anchors.weights[i], " and the depth ", anchors.depths[i], ": both go from 0 to 1.");
    }
  }
}

KeptAnchors anchors_of(const Region& region) {
  KeptAnchors anchors;
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Anchor) {
      anchors.add(region.mesh_vertex[i], region.anchor_weight[i],
                  region.anchor_depth.empty() ? 1 : region.anchor_depth[i]);
    }
  }
  anchors.reach = anchors.empty() ? 0 : region.max_distance;
  return anchors;
}

Region painted_region(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                      const std::vector<std::vector<int>>& groups) {
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Vertices;
  spec.vertices = vertices;
  return RegionBuilder(mesh, adjacency, spec, groups, 1).paint();
}

int held_by_nothing(const Region& region) {
  std::vector<int> group(region.anchored.size(), -1);
  std::vector<char> held(region.anchored.begin(), region.anchored.end());
  for (int i = 0; i < region.size() && !region.anchored.empty(); ++i) {
    int& first = group[region.component[i]];
    held[region.component[i]] |= region.group[i] >= 0 && first >= 0 && region.group[i] != first;
    first = region.group[i] >= 0 ? region.group[i] : first;
  }
  int count = 0;
  for (const int c : region.component) {
    count += held[c] ? 0 : 1;
  }
  return count;
}

}  // namespace lapedit
