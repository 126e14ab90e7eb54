// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {
namespace {

bool is_finite(const Points& points, int vertex) {
  return points.row(vertex).allFinite();
}

/// All handle vertices, ascending; fills the group of each mesh vertex (-1: none).
std::vector<int> collect_handles(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups,
                                 std::vector<int>& group_of) {
  const int n = static_cast<int>(mesh.vertices.rows());
  if (groups.empty()) {
    throw EditError(ErrorCause::NoHandle, "There is no handle: name at least one vertex to move.");
  }
  group_of.assign(n, -1);
  std::vector<int> handles;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].empty()) {
      throw EditError(ErrorCause::NoHandle,
                      "Handle group " + std::to_string(g) + " has no vertices: name at least one vertex to move.");
    }
    for (const int v : groups[g]) {
      if (v < 0 || v >= n) {
        throw EditError(ErrorCause::BadIndex, "Handle vertex " + std::to_string(v) + " does not exist: the mesh has " +
                                                  std::to_string(n) + " vertices, numbered from 0.");
      }
      if (group_of[v] >= 0 && group_of[v] != static_cast<int>(g)) {
        throw EditError(ErrorCause::BadIndex, "Vertex " + std::to_string(v) + " is in handle groups " +
                                                  std::to_string(group_of[v]) + " and " + std::to_string(g) +
                                                  ": it can follow only one of them.");
      }
      if (!is_finite(mesh.vertices, v)) {
        throw EditError(ErrorCause::NotFinite, "Handle vertex " + std::to_string(v) +
                                                   " has a coordinate that is not a number: repair the mesh first.");
      }
      if (group_of[v] < 0) {
        group_of[v] = static_cast<int>(g);
        handles.push_back(v);
      }
    }
  }
  std::sort(handles.begin(), handles.end());
  return handles;
}

/// One flag per mesh vertex of a given set, which has to contain the handle.
std::vector<char> flag_set(const TriangleMesh& mesh, const std::vector<int>& set, const std::vector<int>& handles) {
  const int n = static_cast<int>(mesh.vertices.rows());
  if (set.empty()) {
    throw EditError(ErrorCause::EmptyRegion, "The region has no vertices: select the part of the surface to edit.");
  }
  std::vector<char> flags(n, 0);
  for (const int v : set) {
    if (v < 0 || v >= n) {
      throw EditError(ErrorCause::BadIndex, "Region vertex " + std::to_string(v) + " does not exist: the mesh has " +
                                                std::to_string(n) + " vertices, numbered from 0.");
    }
    flags[v] = 1;
  }
  const auto outside = [&flags](int v) { return !flags[v]; };
  const auto count = std::count_if(handles.begin(), handles.end(), outside);
  if (count > 0) {
    const int first = *std::find_if(handles.begin(), handles.end(), outside);
    throw EditError(ErrorCause::HandleOutsideRegion,
                    std::to_string(count) + " of " + std::to_string(handles.size()) +
                        " handle vertices lie outside the region, the first is vertex " + std::to_string(first) +
                        ": enlarge the region or choose a handle inside it.");
  }
  return flags;
}

/// The region must not hold or touch vertices without usable coordinates: their distance is unknown.
void require_finite_region(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& region,
                           const std::vector<char>* set) {
  int count = 0;
  int first = std::numeric_limits<int>::max();
  auto look_at = [&](int v) {
    if (!is_finite(mesh.vertices, v)) {
      ++count;
      first = std::min(first, v);
    }
  };
  if (set) {
    for (int v = 0; v < static_cast<int>(set->size()); ++v) {
      if ((*set)[v]) {
        look_at(v);
      }
    }
  } else {
    std::vector<int> touched;
    for (const int v : region) {
      for (const int w : adjacency.neighbours[v]) {
        if (!is_finite(mesh.vertices, w)) {
          touched.push_back(w);
        }
      }
    }
    std::sort(touched.begin(), touched.end());
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    for (const int v : touched) {
      look_at(v);
    }
  }
  if (count > 0) {
    throw EditError(ErrorCause::NotFinite,
                    std::to_string(count) + (count == 1 ? " vertex" : " vertices") +
                        " in or next to the region have a coordinate that is not a number, the first is vertex " +
                        std::to_string(first) + ": repair the mesh or choose a region without them.");
  }
}

void check_spec(const RegionSpec& spec) {
  if (!(spec.padding >= 0 && spec.padding <= 1)) {
    throw EditError(ErrorCause::BadParameter, "The padding is " + number_text(spec.padding) +
                                                  ": give a share of the region's radius from 0 to 1.");
  }
  if (spec.kind == RegionSpec::Kind::Radius && !(spec.radius > 0 && std::isfinite(spec.radius))) {
    throw EditError(ErrorCause::BadParameter,
                    "The region's radius is " + number_text(spec.radius) + ": give a finite length greater than 0.");
  }
}

void check_anchors(const KeptAnchors& anchors, int mesh_vertices) {
  const std::size_t count = anchors.vertices.size();
  if (anchors.weights.size() != count || anchors.depths.size() != count) {
    throw EditError(ErrorCause::BadParameter, std::to_string(count) + " kept anchors have " +
                                                  std::to_string(anchors.weights.size()) + " weights and " +
                                                  std::to_string(anchors.depths.size()) +
                                                  " depths: give one of each for each anchor.");
  }
  if (count > 0 && !(anchors.reach > 0 && std::isfinite(anchors.reach))) {
    throw EditError(ErrorCause::BadParameter, "The reach of the kept anchors is " + number_text(anchors.reach) +
                                                  ": give the largest handle distance that they were made with.");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (anchors.vertices[i] < 0 || anchors.vertices[i] >= mesh_vertices) {
      throw EditError(ErrorCause::BadIndex, "Kept anchor " + std::to_string(anchors.vertices[i]) +
                                                " does not exist: the mesh has " + std::to_string(mesh_vertices) +
                                                " vertices, numbered from 0.");
    }
    if (!(anchors.weights[i] >= 0 && anchors.weights[i] <= 1 && anchors.depths[i] >= 0 && anchors.depths[i] <= 1)) {
      throw EditError(ErrorCause::BadParameter, "Kept anchor " + std::to_string(anchors.vertices[i]) +
                                                    " has the weight " + number_text(anchors.weights[i]) +
                                                    " and the depth " + number_text(anchors.depths[i]) +
                                                    ": both go from 0 to 1.");
    }
  }
}

/// Local graph and faces of the chosen vertices.
void extract_submesh(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& local,
                     Region& region) {
  region.neighbours.offsets.assign(1, 0);
  region.neighbours.offsets.reserve(region.mesh_vertex.size() + 1);
  region.neighbours.values.reserve(region.mesh_vertex.size() * 6);
  region.edge_faces.reserve(region.mesh_vertex.size() * 2);
  for (const int v : region.mesh_vertex) {
    for (const int w : adjacency.neighbours[v]) {
      if (local[w] >= 0) {
        region.neighbours.values.push_back(local[w]);
      }
    }
    region.neighbours.offsets.push_back(static_cast<int>(region.neighbours.values.size()));
    for (const int f : adjacency.faces[v]) {
      // The face is listed by its first corner inside, so each comes once.
      int inside = 0;
      int first = -1;
      for (int k = 0; k < 3; ++k) {
        const int corner = mesh.faces(f, k);
        if (local[corner] >= 0) {
          ++inside;
          first = first < 0 ? corner : std::min(first, corner);
        }
      }
      if (first == v && inside >= 2) {
        region.edge_faces.push_back(f);
      }
    }
  }
  // A pass over all faces is faster than sorting, unless there are many more of them.
  constexpr std::size_t kMany = 64;
  const auto all = static_cast<std::size_t>(mesh.faces.rows());
  if (all < kMany * region.edge_faces.size()) {
    std::vector<char> chosen(all, 0);
    for (const int f : region.edge_faces) {
      chosen[f] = 1;
    }
    region.edge_faces.clear();
    for (std::size_t f = 0; f < all; ++f) {
      if (chosen[f]) {
        region.edge_faces.push_back(static_cast<int>(f));
      }
    }
  } else {
    std::sort(region.edge_faces.begin(), region.edge_faces.end());
  }
  region.faces.resize(static_cast<Eigen::Index>(region.edge_faces.size()), 3);
  Eigen::Index whole = 0;
  for (const int f : region.edge_faces) {
    const int a = local[mesh.faces(f, 0)], b = local[mesh.faces(f, 1)], c = local[mesh.faces(f, 2)];
    if (a >= 0 && b >= 0 && c >= 0) {
      region.faces.row(whole++) << a, b, c;
    }
  }
  region.faces.conservativeResize(whole, 3);
}

/// Flags the region's vertices with a mesh neighbour outside.
std::vector<char> find_rim(const Adjacency& adjacency, const std::vector<int>& local, const Region& region) {
  std::vector<char> rim(region.size(), 0);
  for (int i = 0; i < region.size(); ++i) {
    for (const int w : adjacency.neighbours[region.mesh_vertex[i]]) {
      rim[i] |= local[w] < 0;
    }
  }
  return rim;
}

/// Distances from the rim inside the region, for the anchor band of a given set.
std::vector<double> distances_from(const std::vector<char>& rim, const Region& region, const TriangleMesh& mesh,
                                   double cutoff) {
  Points points(region.size(), 3);
  std::vector<int> seeds;
  for (int i = 0; i < region.size(); ++i) {
    points.row(i) = mesh.vertices.row(region.mesh_vertex[i]);
    if (rim[i]) {
      seeds.push_back(i);
    }
  }
  GeodesicSearch search(region.neighbours, points);
  search.run(seeds, cutoff);
  std::vector<double> distances(region.size());
  for (int i = 0; i < region.size(); ++i) {
    distances[i] = search.distance(i);
  }
  return distances;
}

/// Where the anchors are: how far into their band each vertex is, 0 or less outside it, 1 at its far end; and the
/// weights of kept ones.
struct AnchorBand {
  std::vector<double> depth;
  std::vector<double> kept_weight;  // -1 where none is kept; no entries if none are
};

/// With d the distance from the handle, b that from the rim, p the padding, r the radius and d_max the largest d:
///   grown by a radius:  (d - (1 - p) r) / (p r)
///   a given set:        1 - b / (p d_max)
///   kept anchors:       as they came
AnchorBand anchor_band(const TriangleMesh& mesh, const RegionSpec& spec, const std::vector<int>& local,
                       const std::vector<char>& rim, const Region& region) {
  const int n = region.size();
  AnchorBand band;
  band.depth.resize(n);
  if (spec.kind == RegionSpec::Kind::Vertices && !spec.anchors.empty()) {
    band.kept_weight.assign(n, -1);
    for (std::size_t k = 0; k < spec.anchors.vertices.size(); ++k) {
      const int i = local[spec.anchors.vertices[k]];
      if (i >= 0) {
        band.depth[i] = spec.anchors.depths[k];
        band.kept_weight[i] = spec.anchors.weights[k];
      }
    }
  } else if (spec.kind == RegionSpec::Kind::Vertices) {
    const double width = spec.padding * region.max_distance;
    band.depth = distances_from(rim, region, mesh, width);
    for (double& d : band.depth) {
      d = width > 0 ? 1 - d / width : 0;
    }
  } else if (spec.kind == RegionSpec::Kind::Radius && spec.padding > 0) {
    for (int i = 0; i < n; ++i) {
      band.depth[i] = (region.distance[i] - (1 - spec.padding) * spec.radius) / (spec.padding * spec.radius);
    }
  }
  return band;
}

/// Handle, anchor or free. An anchor's weight is d / d_max, so that those near the handle give way to it.
void classify(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
              const std::vector<int>& local, const std::vector<int>& group_of, Region& region) {
  const int n = region.size();
  const std::vector<char> rim = find_rim(adjacency, local, region);
  const AnchorBand band = anchor_band(mesh, spec, local, rim, region);
  region.classes.assign(n, VertexClass::Free);
  region.group.assign(n, -1);
  region.anchor_weight.assign(n, 0);
  region.anchor_depth.assign(n, 0);
  for (int i = 0; i < n; ++i) {
    const int group = group_of[region.mesh_vertex[i]];
    const bool kept = !band.kept_weight.empty() && band.kept_weight[i] >= 0;
    const bool anchor = rim[i] || band.depth[i] > 0 || kept;
    if (group >= 0) {
      region.classes[i] = VertexClass::Handle;
      region.group[i] = group;
    } else if (anchor) {
      region.classes[i] = VertexClass::Anchor;
      region.anchor_depth[i] = rim[i] ? 1 : std::min(band.depth[i], 1.0);
      region.anchor_weight[i] = kept                      ? band.kept_weight[i]
                                : region.max_distance > 0 ? std::min(1.0, region.distance[i] / region.max_distance)
                                                          : 1;
    }
  }
  const int components = connected_components(region.neighbours, region.component);
  region.anchored.assign(components, 0);
  for (int i = 0; i < n; ++i) {
    region.anchored[region.component[i]] |= region.classes[i] == VertexClass::Anchor;
  }
}

[[noreturn]] void refuse_handle_only(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                                     const std::vector<int>& handles) {
  std::string sentence = "The region is the handle alone (" + std::to_string(handles.size()) +
                         (handles.size() == 1 ? " vertex" : " vertices") + "), so nothing would follow it: ";
  double shortest = kUnreached;
  for (const int v : handles) {
    for (const int w : adjacency.neighbours[v]) {
      if (!std::binary_search(handles.begin(), handles.end(), w)) {
        shortest = std::min(shortest, (mesh.vertices.row(w) - mesh.vertices.row(v)).norm());
      }
    }
  }
  if (spec.kind == RegionSpec::Kind::Radius && std::isfinite(shortest)) {
    sentence += "give a radius above " + number_text(shortest) + ", the handle's shortest edge, instead of " +
                number_text(spec.radius) + ".";
  } else if (std::isfinite(shortest)) {
    sentence += "enlarge the region beyond the handle.";
  } else {
    sentence += "choose a handle that is a part of a connected surface, not all of it.";
  }
  throw EditError(ErrorCause::NothingToFollow, sentence);
}

}  // namespace

int Region::count(VertexClass c) const {
  return static_cast<int>(std::count(classes.begin(), classes.end(), c));
}

Region build_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                    const std::vector<std::vector<int>>& groups) {
  check_spec(spec);
  std::vector<int> group_of;
  const std::vector<int> handles = collect_handles(mesh, groups, group_of);
  const bool given_set = spec.kind == RegionSpec::Kind::Vertices;
  std::vector<char> flags;
  if (given_set) {
    flags = flag_set(mesh, spec.vertices, handles);
  }
  GeodesicSearch search(adjacency.neighbours, mesh.vertices);
  if (given_set) {
    check_anchors(spec.anchors, static_cast<int>(mesh.vertices.rows()));
  }
  const double cutoff = spec.kind == RegionSpec::Kind::Radius ? spec.radius : kUnreached;

  Region region;
  region.mesh_vertex = search.run(handles, cutoff, given_set ? &flags : nullptr);
  require_finite_region(mesh, adjacency, region.mesh_vertex, given_set ? &flags : nullptr);
  region.max_distance = search.distance(region.mesh_vertex.back());
  if (region.mesh_vertex.size() == handles.size()) {
    refuse_handle_only(mesh, adjacency, spec, handles);
  }
  region.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  if (given_set && !spec.anchors.empty()) {
    region.max_distance = spec.anchors.reach;
  }
  region.radius = spec.kind == RegionSpec::Kind::Radius ? spec.radius : region.max_distance;
  if (given_set) {
    region.left_out = static_cast<int>(std::count(flags.begin(), flags.end(), 1)) - region.size();
  }
  // Numbered in the order of the mesh, by a pass over it: it is cheaper than sorting.
  std::vector<int> local(mesh.vertices.rows(), -1);
  for (const int v : region.mesh_vertex) {
    local[v] = 0;
  }
  region.mesh_vertex.clear();
  for (int v = 0; v < region.mesh_vertices; ++v) {
    if (local[v] == 0) {
      local[v] = region.size();
      region.mesh_vertex.push_back(v);
      region.distance.push_back(search.distance(v));
    }
  }
  extract_submesh(mesh, adjacency, local, region);
  classify(mesh, adjacency, spec, local, group_of, region);
  return region;
}

KeptAnchors anchors_of(const Region& region) {
  KeptAnchors anchors;
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Anchor) {
      anchors.vertices.push_back(region.mesh_vertex[i]);
      anchors.weights.push_back(region.anchor_weight[i]);
      anchors.depths.push_back(region.anchor_depth.empty() ? 1 : region.anchor_depth[i]);
    }
  }
  anchors.reach = anchors.empty() ? 0 : region.max_distance;
  return anchors;
}

int nearest_vertex(const TriangleMesh& mesh, const Vector3& point) {
  if (!point.allFinite()) {
    throw EditError(ErrorCause::NotFinite,
                    "The handle point is not finite: give three finite coordinates on the surface.");
  }
  std::vector<char> used(mesh.vertices.rows(), 0);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      used[mesh.faces(f, k)] = 1;
    }
  }
  Eigen::AlignedBox3d box;
  int nearest = -1;
  double best = kUnreached;
  for (int v = 0; v < static_cast<int>(mesh.vertices.rows()); ++v) {
    if (!used[v] || !is_finite(mesh.vertices, v)) {
      continue;
    }
    const Vector3 place = mesh.vertices.row(v).transpose();
    box.extend(place);
    const double distance = (place - point).norm();
    if (distance < best) {
      best = distance;
      nearest = v;
    }
  }
  if (nearest < 0) {
    throw EditError(ErrorCause::NotFinite,
                    "No vertex of the mesh has three finite coordinates: repair the mesh first.");
  }
  constexpr double kFar = 0.1;
  if (best > kFar * box.diagonal().norm()) {
    throw EditError(ErrorCause::BadParameter,
                    "The handle point (" + number_text(point[0]) + ", " + number_text(point[1]) + ", " +
                        number_text(point[2]) + ") is " + number_text(best) + " away from the nearest vertex, number " +
                        std::to_string(nearest) + ", more than a tenth of the mesh's bounding-box diagonal (" +
                        number_text(box.diagonal().norm()) + "): give a point on the surface.");
  }
  return nearest;
}

}  // namespace lapedit
