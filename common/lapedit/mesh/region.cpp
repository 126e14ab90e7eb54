// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/region.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"
#include "lapedit/mesh/connect.h"
#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

bool is_finite(const Points& points, int vertex) {
  return points.row(vertex).allFinite();
}

std::string key_of(std::size_t group, const char* key) {
  return "handles[" + std::to_string(group) + "]." + key;
}

/// Returns all handle vertices, ascending, and fills the group of each mesh vertex (-1: none).
std::vector<int> collect_handles(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups,
                                 bool without_handle, std::vector<int>& group_of) {
  const int n = static_cast<int>(mesh.vertices.rows());
  if (groups.empty() && !without_handle) {
    throw EditError(ErrorCause::NoHandle, "There is no handle: name at least one vertex to move.").at("handles");
  }
  group_of.assign(n, -1);
  std::vector<int> handles;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].empty()) {
      throw EditError(ErrorCause::NoHandle,
                      "Handle group " + std::to_string(g) + " has no vertices: name at least one vertex to move.")
          .at(key_of(g, "vertices"));
    }
    for (const int v : groups[g]) {
      keyed("handles", g, [&] { require_vertex("Handle vertex", v, n); });
      if (group_of[v] >= 0 && group_of[v] != static_cast<int>(g)) {
        throw EditError(ErrorCause::BadIndex,
                        "Vertex " + std::to_string(v) + " is in handle groups " + std::to_string(group_of[v]) +
                            " and " + std::to_string(g) + ": it can follow only one of them.",
                        v)
            .at(key_of(g, "vertices"));
      }
      if (!is_finite(mesh.vertices, v)) {
        throw EditError(
            ErrorCause::NotFinite,
            "Handle vertex " + std::to_string(v) + " has a coordinate that is not a number: repair the mesh first.", v)
            .at(key_of(g, "vertices"));
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

void check_weights(const std::vector<std::vector<int>>& groups, const std::vector<std::vector<double>>& weights) {
  for (std::size_t g = 0; g < weights.size(); ++g) {
    const std::size_t vertices = g < groups.size() ? groups[g].size() : 0;
    if (!weights[g].empty() && weights[g].size() != vertices) {
      throw EditError(ErrorCause::BadParameter, "Handle group " + std::to_string(g) + " has " +
                                                    std::to_string(vertices) + " vertices and " +
                                                    std::to_string(weights[g].size()) +
                                                    " weights: give one weight for each vertex, or none at all.")
          .at(key_of(g, "weights"));
    }
    for (std::size_t k = 0; k < weights[g].size(); ++k) {
      if (!(weights[g][k] >= kLeastWeight && weights[g][k] <= 1)) {
        throw EditError(ErrorCause::BadParameter,
                        "Handle vertex " + std::to_string(groups[g][k]) + " has the weight " +
                            number_text(weights[g][k]) + ": weights of handle vertices go from 0.000001 to 1.",
                        groups[g][k])
            .at(key_of(g, "weights"));
      }
    }
  }
}

/// Returns a flag for each vertex of the mesh: whether it is in the set. The set has to contain the handles.
std::vector<char> flag_set(const TriangleMesh& mesh, const std::vector<int>& set, const std::vector<int>& handles) {
  const int n = static_cast<int>(mesh.vertices.rows());
  if (set.empty()) {
    throw EditError(ErrorCause::EmptyRegion, "The region has no vertices: select the part of the surface to edit.")
        .at("region.vertices");
  }
  std::vector<char> flags(n, 0);
  for (const int v : set) {
    require_vertex("Region vertex", v, n, "region.vertices");
    flags[v] = 1;
  }
  const auto outside = [&flags](int v) { return !flags[v]; };
  const auto count = std::count_if(handles.begin(), handles.end(), outside);
  if (count > 0) {
    const int first = *std::find_if(handles.begin(), handles.end(), outside);
    throw EditError(ErrorCause::HandleOutsideRegion,
                    std::to_string(count) + " of " + std::to_string(handles.size()) +
                        " handle vertices lie outside the region, the first is vertex " + std::to_string(first) +
                        ": enlarge the region or choose a handle inside it.",
                    first)
        .at("region");
  }
  return flags;
}

/// Throws EditError if a vertex of the given set, or else in or next to the region, has non-finite coordinates, since
/// its distance is unknown. @param vertices the set or the region, any order
void require_finite(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                    bool given_set) {
  std::vector<int> bad;
  const auto look_at = [&](int v) {
    if (!is_finite(mesh.vertices, v)) {
      bad.push_back(v);
    }
  };
  for (const int v : vertices) {
    look_at(v);
    if (!given_set) {
      const CompressedRows::Row ring = adjacency.neighbours[v];
      std::for_each(ring.begin(), ring.end(), look_at);
    }
  }
  std::sort(bad.begin(), bad.end());
  bad.erase(std::unique(bad.begin(), bad.end()), bad.end());
  if (!bad.empty()) {
    throw EditError(ErrorCause::NotFinite,
                    std::to_string(bad.size()) + (bad.size() == 1 ? " vertex" : " vertices") +
                        " in or next to the region have a coordinate that is not a number, the first is vertex " +
                        std::to_string(bad[0]) + ": repair the mesh or choose a region without them.",
                    bad[0])
        .at("region");
  }
}

void check_spec(const RegionSpec& spec) {
  if (!(spec.padding >= 0 && spec.padding <= 1)) {
    throw EditError(ErrorCause::BadParameter, "The padding is " + number_text(spec.padding) +
                                                  ": give a fraction of the region's radius from 0 to 1.")
        .at("region.padding");
  }
  if (spec.kind == RegionSpec::Kind::Radius && !(spec.radius > 0 && std::isfinite(spec.radius))) {
    throw EditError(ErrorCause::BadParameter,
                    "The region's radius is " + number_text(spec.radius) + ": give a finite length greater than 0.")
        .at("region.radius");
  }
}

/// Collects selected elements of [0, count), in order and on several threads: select(first, last) counts two kinds of
/// elements, reserve(total) allocates, take(first, last, place) writes them.
using Counts = std::array<int, 2>;
template <class Select, class Reserve, class Take>
void gather(ThreadPool& pool, int count, const Select& select, const Reserve& reserve, const Take& take) {
  constexpr int kGrain = 4096;
  constexpr int kPiecesPerThread = 4;  // since threads are seldom equally fast
  const int pieces = std::max(1, std::min(count / kGrain, kPiecesPerThread * pool.threads()));
  std::vector<Counts> positions(pieces + 1, Counts{0, 0});
  in_chunks(pool, pieces, count, [&](int piece, std::int64_t first, std::int64_t last) {
    positions[piece + 1] = select(static_cast<int>(first), static_cast<int>(last));
  });
  for (int piece = 0; piece < pieces; ++piece) {
    for (int kind = 0; kind < 2; ++kind) {
      positions[piece + 1][kind] += positions[piece][kind];
    }
  }
  reserve(positions[pieces]);
  in_chunks(pool, pieces, count, [&](int piece, std::int64_t first, std::int64_t last) {
    take(static_cast<int>(first), static_cast<int>(last), positions[piece]);
  });
}

/// Calls each of the functions once, on several threads, since page faults of new memory take most of their time.
template <class... Functions>
void at_once(ThreadPool& pool, const Functions&... functions) {
  const std::array<std::function<void()>, sizeof...(functions)> list = {functions...};
  pool.each(static_cast<int>(list.size()), [&list](int i) { list[i](); });
}

/// Numbers the reached vertices in the order of the mesh. @param local out: mesh vertex -> local vertex, or -1
template <class Field>
void number_vertices(ThreadPool& pool, const Field& field, std::vector<int>& local, Region& region) {
  gather(
      pool, region.mesh_vertices,
      [&](int first, int last) {
        int count = 0;
        for (int v = first; v < last; ++v) {
          count += field[v] < kUnreached;
        }
        return Counts{count, 0};
      },
      [&](const Counts& total) {
        at_once(
            pool, [&] { region.mesh_vertex.resize(total[0]); }, [&] { region.distance.resize(total[0]); });
      },
      [&](int first, int last, const Counts& index) {
        int i = index[0];
        for (int v = first; v < last; ++v) {
          const double distance = field[v];
          local[v] = -1;
          if (distance < kUnreached) {
            local[v] = i;
            region.mesh_vertex[i] = v;
            region.distance[i++] = distance;
          }
        }
      });
}

/// Makes the region's graph. @param boundary out: one flag per local vertex, whether it has a mesh neighbour outside
/// @return whether all neighbours outside have finite coordinates
bool extract_graph(ThreadPool& pool, const TriangleMesh& mesh, const Adjacency& adjacency,
                   const std::vector<int>& local, std::vector<char>& boundary, Region& region) {
  std::vector<int>& offsets = region.neighbours.offsets;
  std::vector<int>& values = region.neighbours.values;
  std::atomic<bool> finite{true};
  const bool is_whole = region.size() == region.mesh_vertices;  // no lookup needed then
  at_once(
      pool, [&] { offsets.resize(region.mesh_vertex.size() + 1); },
      [&] { boundary.resize(region.mesh_vertex.size()); });
  gather(
      pool, region.size(),
      [&](int first, int last) {
        int count = 0;
        for (int i = first; i < last; ++i) {
          const CompressedRows::Row ring = adjacency.neighbours[region.mesh_vertex[i]];
          int inside = is_whole ? ring.size() : 0;
          for (int k = 0; !is_whole && k < ring.size(); ++k) {
            inside += local[ring.first[k]] >= 0;
          }
          boundary[i] = inside < ring.size();
          if (boundary[i] &&
              !std::all_of(ring.begin(), ring.end(), [&](int w) { return is_finite(mesh.vertices, w); })) {
            finite = false;
          }
          count += inside;
        }
        return Counts{count, 0};
      },
      [&](const Counts& total) { values.resize(total[0]); },
      [&](int first, int last, const Counts& index) {
        int end = index[0];
        for (int i = first; i < last; ++i) {
          for (const int w : adjacency.neighbours[region.mesh_vertex[i]]) {
            if (local[w] >= 0) {
              values[end++] = local[w];
            }
          }
          offsets[i + 1] = end;
        }
      });
  return finite;
}

/// Finds the faces that touch a region edge, and those inside.
void extract_faces(ThreadPool& pool, const TriangleMesh& mesh, const Adjacency& adjacency,
                   const std::vector<int>& local, Region& region) {
  // A pass over all faces is faster than collecting and sorting, unless the mesh has many more faces than the region.
  constexpr Eigen::Index kMany = 32;
  const bool is_small = mesh.faces.rows() > kMany * region.size();
  const auto is_inside = [&](int f, int k) { return local[mesh.faces(f, k)] >= 0; };
  std::vector<int> around;
  for (int i = 0; is_small && i < region.size(); ++i) {
    for (const int f : adjacency.faces[region.mesh_vertex[i]]) {
      // Each face is listed once, by its lowest corner inside.
      bool is_lowest = true;
      for (int k = 0; k < 3; ++k) {
        is_lowest = is_lowest && (!is_inside(f, k) || local[mesh.faces(f, k)] >= i);
      }
      if (is_lowest) {
        around.push_back(f);
      }
    }
  }
  std::sort(around.begin(), around.end());
  const auto face = [&](int index) { return is_small ? around[index] : index; };
  const bool is_whole = region.size() == region.mesh_vertices;
  const auto corners_inside = [&](int f) { return is_whole ? 3 : is_inside(f, 0) + is_inside(f, 1) + is_inside(f, 2); };
  gather(
      pool, static_cast<int>(is_small ? around.size() : mesh.faces.rows()),
      [&](int first, int last) {
        Counts count{0, 0};
        for (int i = first; i < last; ++i) {
          const int corners = corners_inside(face(i));
          count[0] += corners >= 2;
          count[1] += corners == 3;
        }
        return count;
      },
      [&](const Counts& total) {
        region.edge_faces.resize(total[0]);
        region.faces.resize(total[1], 3);
      },
      [&](int first, int last, Counts index) {
        for (int i = first; i < last; ++i) {
          const int f = face(i), corners = corners_inside(f);
          if (corners >= 2) {
            region.edge_faces[index[0]++] = f;
          }
          if (corners == 3) {
            region.faces.row(index[1]++) << local[mesh.faces(f, 0)], local[mesh.faces(f, 1)], local[mesh.faces(f, 2)];
          }
        }
      });
}

constexpr int kGrain = 4096;

/// Computes anchor_depth, the depth of each vertex in the anchor band (0 or less outside it, 1 at its far end), and
/// anchor_weight, the weight of kept anchors (-1 for all others). With d the distance from the handle, b that from the
/// boundary, p the padding, r the radius and d_max the largest d:
///     grown by a radius:  (d - (1 - p) r) / (p r)
///     a given set:        1 - b / (p d_max)
///     kept anchors:       as given
/// @param is_free  per mesh vertex, whether it is excluded from the band; may be empty
void place_anchor_band(ThreadPool& pool, const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                       const std::vector<int>& local, const std::vector<char>& boundary,
                       const std::vector<char>& is_free, Region& region) {
  const auto each = [&](const auto& body) {
    in_pieces(pool, region.size(), kGrain, [&body](int first, int last) {
      for (int i = first; i < last; ++i) {
        body(i);
      }
    });
  };
  std::vector<double>& depth = region.anchor_depth;
  if (spec.kind == RegionSpec::Kind::Vertices && !spec.anchors.empty()) {
    for (std::size_t k = 0; k < spec.anchors.vertices.size(); ++k) {
      const int i = local[spec.anchors.vertices[k]];
      if (i >= 0) {
        depth[i] = spec.anchors.depths[k];
        region.anchor_weight[i] = spec.anchors.weights[k];
      }
    }
  } else if (spec.kind == RegionSpec::Kind::Vertices) {
    const double width = spec.padding * region.max_distance;
    std::vector<int> seeds;
    std::vector<char> inside(mesh.vertices.rows(), 0);
    for (int i = 0; i < region.size(); ++i) {
      inside[region.mesh_vertex[i]] = 1;
      if (boundary[i]) {
        seeds.push_back(region.mesh_vertex[i]);
      }
    }
    const DistanceField from_boundary({mesh, adjacency}, seeds, width, &inside, pool);
    each([&](int i) { depth[i] = width > 0 ? 1 - from_boundary[region.mesh_vertex[i]] / width : 0; });
  } else if (spec.kind == RegionSpec::Kind::Radius && spec.padding > 0) {
    each([&](int i) {
      depth[i] = (region.distance[i] - (1 - spec.padding) * spec.radius) / (spec.padding * spec.radius);
    });
  }
  if (!is_free.empty()) {
    each([&](int i) { depth[i] = is_free[region.mesh_vertex[i]] ? 0 : depth[i]; });
  }
  for (const int v : spec.held) {
    if (const int i = local[v]; i >= 0) {
      depth[i] = region.anchor_weight[i] = 1;
    }
  }
}

/// Classifies vertices as handle, anchor or free. An anchor's weight is d / d_max, so that anchors near the handle are
/// weak.
/// @param handles  local vertices, and their groups
void classify(ThreadPool& pool, const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
              const std::vector<int>& local, const std::vector<std::pair<int, int>>& handles,
              const std::vector<char>& boundary, const std::vector<char>& is_free, Region& region) {
  const int n = region.size();
  at_once(
      pool, [&] { region.classes.assign(n, VertexClass::Free); }, [&] { region.group.assign(n, -1); },
      [&] { region.anchor_weight.assign(n, -1); }, [&] { region.anchor_depth.assign(n, 0); });
  place_anchor_band(pool, mesh, adjacency, spec, local, boundary, is_free, region);
  in_pieces(pool, n, kGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      double& depth = region.anchor_depth[i];
      double& weight = region.anchor_weight[i];
      const bool kept = weight >= 0;
      if (boundary[i] || depth > kRoundedLength || kept) {
        region.classes[i] = VertexClass::Anchor;
        depth = boundary[i] ? 1 : std::min(depth, 1.0);
        weight = kept ? weight : region.max_distance > 0 ? std::min(1.0, region.distance[i] / region.max_distance) : 1;
      } else {
        depth = weight = 0;
      }
    }
  });
  for (const auto& [i, group] : handles) {
    region.classes[i] = VertexClass::Handle;
    region.group[i] = group;
    region.anchor_depth[i] = region.anchor_weight[i] = 0;
  }
}

/// Stores weights unless all are 1. A vertex that is listed twice gets the larger weight.
void take_weights(const std::vector<std::vector<int>>& groups, const std::vector<std::vector<double>>& weights,
                  const std::vector<int>& local, Region& region) {
  for (std::size_t g = 0; g < weights.size(); ++g) {
    for (std::size_t k = 0; k < weights[g].size(); ++k) {
      if (weights[g][k] < 1 && region.handle_weight.empty()) {
        region.handle_weight.assign(region.mesh_vertex.size(), 0);
      }
    }
  }
  for (std::size_t g = 0; !region.handle_weight.empty() && g < weights.size(); ++g) {
    for (std::size_t k = 0; k < weights[g].size(); ++k) {
      double& weight = region.handle_weight[local[groups[g][k]]];
      weight = std::max(weight, weights[g][k]);
    }
  }
  for (double& weight : region.handle_weight) {
    weight = weight > 0 ? weight : 1;
  }
}

/// Returns whether the handles' own edges connect them all. The region, which is reached from them, is connected then.
bool are_connected(const std::vector<std::pair<int, int>>& handles, const Region& region) {
  if (handles.empty()) {
    return false;
  }
  std::vector<int> found{handles[0].first};
  if (handles.size() > 1) {
    std::vector<char> is_found(region.size(), 0);
    is_found[found[0]] = 1;
    for (std::size_t k = 0; k < found.size(); ++k) {
      for (const int w : region.neighbours[found[k]]) {
        if (region.group[w] >= 0 && !is_found[w]) {
          is_found[w] = 1;
          found.push_back(w);
        }
      }
    }
  }
  return found.size() == handles.size();
}

void find_components(const std::vector<std::pair<int, int>>& handles, Region& region) {
  int components = 1;
  if (are_connected(handles, region)) {
    region.component.assign(region.size(), 0);
  } else {
    components = connected_components(region.neighbours, region.component);
  }
  region.anchored.assign(components, 0);
  for (int i = 0; i < region.size(); ++i) {
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

/// Returns the vertices of a set that have neighbours outside.
std::vector<int> boundary_of(const Adjacency& adjacency, const std::vector<char>& flags) {
  std::vector<int> boundary;
  for (int v = 0; v < static_cast<int>(flags.size()); ++v) {
    const CompressedRows::Row ring = adjacency.neighbours[v];
    if (flags[v] && std::any_of(ring.begin(), ring.end(), [&flags](int w) { return !flags[w]; })) {
      boundary.push_back(v);
    }
  }
  return boundary;
}

/// Replaces distances from the boundary of a region without a handle.
void measure_from_the_middle(Region& region) {
  if (region.size() == 0) {
    throw EditError(
        ErrorCause::NothingToFollow,
        "The region is a whole piece of the surface, so no vertex around it stays: choose a smaller region, "
        "or give a handle.")
        .at("region");
  }
  const double largest = *std::max_element(region.distance.begin(), region.distance.end());
  for (double& distance : region.distance) {
    distance = largest - distance;
  }
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

/// Returns flags of the vertices whose links count: those of a given set, or those near enough to be part of a region
/// of a radius, to be linked to its vertices, to compete for these links, or to be what competitors are linked to
/// instead.
std::vector<char> linkable(const TriangleMesh& mesh, const RegionSpec& spec,
                           const std::vector<std::vector<int>>& groups) {
  const int n = static_cast<int>(mesh.vertices.rows());
  const bool near = spec.kind == RegionSpec::Kind::Radius && !spec.tips && !spec.pieces;
  std::vector<char> flags(n, !near && spec.kind != RegionSpec::Kind::Vertices);
  if (spec.kind == RegionSpec::Kind::Vertices) {
    for (const int v : spec.vertices) {
      if (v >= 0 && v < n) {
        flags[v] = 1;
      }
    }
  } else if (near) {
    std::vector<int> group_of;
    const Eigen::AlignedBox3d box = bounding_box(mesh.vertices, collect_handles(mesh, groups, false, group_of));
    const Vector3 margin = Vector3::Constant(rounded_up(spec.radius + 3 * spec.connect_gap));
    const Eigen::AlignedBox3d reach(box.min() - margin, box.max() + margin);
    for (int v = 0; v < n; ++v) {
      flags[v] = reach.contains(Vector3(mesh.vertices.row(v)));
    }
  }
  return flags;
}

/// Links that leave a given set make no boundary, since vertices outside the set do not constrain it.
Region build_connected(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                       const std::vector<std::vector<int>>& groups, int threads,
                       const std::vector<std::vector<double>>& weights) {
  const std::vector<char> flags = linkable(mesh, spec, groups);
  const Adjacency linked{linked_neighbours(mesh, adjacency.neighbours, spec.connect_gap, &flags), adjacency.faces};
  RegionSpec plain = spec;
  plain.connect_gap = 0;
  Region region = build_region(mesh, linked, plain, groups, threads, weights);
  find_links(adjacency, region);
  return region;
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
  if (spec.connect_gap != 0) {
    return build_connected(mesh, adjacency, spec, groups, threads, weights);
  }
  std::vector<int> local;  // holds the handles' groups first
  const bool given_set = spec.kind == RegionSpec::Kind::Vertices;
  const std::vector<int> handles = collect_handles(mesh, groups, given_set && spec.without_handle, local);
  check_weights(groups, weights);
  std::vector<std::pair<int, int>> local_handles;
  local_handles.reserve(handles.size());
  for (const int v : handles) {
    local_handles.emplace_back(v, local[v]);
  }
  std::vector<char> flags;
  if (given_set) {
    flags = flag_set(mesh, spec.vertices, handles);
    check_anchors(spec.anchors, static_cast<int>(mesh.vertices.rows()));
  }
  const double cutoff = spec.kind == RegionSpec::Kind::Radius ? rounded_up(spec.radius) : kUnreached;

  Region region;
  region.kind = spec.kind;
  region.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  ThreadPool pool(region.mesh_vertices >= 4 * kGrain ? threads : 1);
  Attached attached;
  {
    const std::vector<int> seeds = handles.empty() ? boundary_of(adjacency, flags) : handles;
    const DistanceField field({mesh, adjacency}, seeds, cutoff, given_set ? &flags : nullptr, pool);
    if (spec.tips || spec.pieces) {
      std::vector<double> distance(local.size());
      for (int v = 0; v < region.mesh_vertices; ++v) {
        distance[v] = field[v];
      }
      attached = attached_to(mesh, adjacency, spec, std::move(distance), flags);
      number_vertices(pool, attached.distance, local, region);
    } else {
      number_vertices(pool, field, local, region);
    }
  }
  region.pieces = attached.pieces;
  if (handles.empty()) {
    measure_from_the_middle(region);
    region.without_handle = true;
  }
  for (auto& handle : local_handles) {
    handle.first = local[handle.first];
  }
  if (given_set) {
    require_finite(mesh, adjacency, spec.vertices, true);
  }
  if (!handles.empty() && region.size() == static_cast<int>(handles.size())) {
    require_finite(mesh, adjacency, region.mesh_vertex, given_set);
    refuse_handle_only(mesh, adjacency, spec, handles);
  }
  region.max_distance = given_set && !spec.anchors.empty()
                            ? spec.anchors.reach
                            : Eigen::Map<const Eigen::VectorXd>(region.distance.data(), region.size()).maxCoeff();
  region.radius = spec.kind == RegionSpec::Kind::Radius ? spec.radius : region.max_distance;
  if (given_set) {
    region.left_out = static_cast<int>(std::count(flags.begin(), flags.end(), 1)) - region.size();
  }
  std::vector<char> boundary;
  const Adjacency linked{attached.links.empty() ? CompressedRows() : with_edges(adjacency.neighbours, attached.links),
                         {}};
  if (!extract_graph(pool, mesh, attached.links.empty() ? adjacency : linked, local, boundary, region) && !given_set) {
    require_finite(mesh, adjacency, region.mesh_vertex, false);
  }
  if (!attached.links.empty()) {
    find_links(adjacency, region);
  }
  extract_faces(pool, mesh, adjacency, local, region);
  classify(pool, mesh, adjacency, spec, local, local_handles, boundary, attached.is_free, region);
  find_components(local_handles, region);
  take_weights(groups, weights, local, region);
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
    throw EditError(ErrorCause::BadParameter, std::to_string(count) + " kept anchors have " +
                                                  std::to_string(anchors.weights.size()) + " weights and " +
                                                  std::to_string(anchors.depths.size()) +
                                                  " depths: give one of each for each anchor.")
        .at("region.anchors");
  }
  if (count > 0 && !(anchors.reach > 0 && std::isfinite(anchors.reach))) {
    throw EditError(ErrorCause::BadParameter, "The reach of the kept anchors is " + number_text(anchors.reach) +
                                                  ": give the largest handle distance that they were made with.")
        .at("region.anchors.reach");
  }
  for (std::size_t i = 0; i < count; ++i) {
    require_vertex("Kept anchor", anchors.vertices[i], mesh_vertices, "region.anchors.vertices");
    if (!(anchors.weights[i] >= 0 && anchors.weights[i] <= 1 && anchors.depths[i] >= 0 && anchors.depths[i] <= 1)) {
      throw EditError(ErrorCause::BadParameter, "Kept anchor " + std::to_string(anchors.vertices[i]) +
                                                    " has the weight " + number_text(anchors.weights[i]) +
                                                    " and the depth " + number_text(anchors.depths[i]) +
                                                    ": both go from 0 to 1.")
          .at("region.anchors");
    }
  }
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

Region painted_region(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                      const std::vector<std::vector<int>>& groups) {
  Region region;
  region.mesh_vertex = vertices;
  region.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  region.classes.assign(vertices.size(), VertexClass::Free);
  std::vector<int> position(mesh.vertices.rows(), 0);  // in the region, from 1
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    position[vertices[i]] = static_cast<int>(i) + 1;
  }
  const auto local = [&position](int v) { return position[v] - 1; };
  std::vector<int> corners;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (const int w : adjacency.neighbours[vertices[i]]) {
      if (local(w) < 0) {
        region.classes[i] = VertexClass::Anchor;
      }
    }
    for (const int f : adjacency.faces[vertices[i]]) {
      const int a = local(mesh.faces(f, 0));
      const int b = local(mesh.faces(f, 1));
      const int c = local(mesh.faces(f, 2));
      // Each face is listed once, by its lowest corner.
      if (a >= 0 && b >= 0 && c >= 0 && std::min({a, b, c}) == static_cast<int>(i)) {
        corners.insert(corners.end(), {a, b, c});
      }
    }
  }
  for (const std::vector<int>& group : groups) {
    for (const int v : group) {
      if (local(v) >= 0) {
        region.classes[local(v)] = VertexClass::Handle;
      }
    }
  }
  region.faces = Eigen::Map<const Faces>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return region;
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
