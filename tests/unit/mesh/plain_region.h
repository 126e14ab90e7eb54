// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/region.h"
#include "support.h"

namespace lapedit::support {

/// build_region() step by step, for input that it does not refuse: passes over all there is, on one thread.
inline Region plain_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                           const std::vector<std::vector<int>>& groups) {
  const int n = static_cast<int>(mesh.vertices.rows());
  const bool given_set = spec.kind == RegionSpec::Kind::Vertices;
  std::vector<int> handles, group_of(n, -1);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const int v : groups[g]) {
      handles.push_back(v);
      group_of[v] = static_cast<int>(g);
    }
  }
  std::vector<char> set(n, given_set ? 0 : 1);
  for (const int v : spec.vertices) {
    set[v] = 1;
  }
  Region region;
  region.mesh_vertices = n;
  GeodesicSearch search({mesh, adjacency});
  region.mesh_vertex =
      search.run(handles, spec.kind == RegionSpec::Kind::Radius ? rounded_up(spec.radius) : kUnreached, &set);
  region.max_distance = search.distance(region.mesh_vertex.back());
  std::sort(region.mesh_vertex.begin(), region.mesh_vertex.end());
  if (!spec.anchors.empty()) {
    region.max_distance = spec.anchors.reach;
  }
  region.radius = spec.kind == RegionSpec::Kind::Radius ? spec.radius : region.max_distance;
  region.left_out = given_set ? static_cast<int>(std::count(set.begin(), set.end(), 1)) - region.size() : 0;

  std::vector<int> local(n, -1), boundary;
  for (int i = 0; i < region.size(); ++i) {
    local[region.mesh_vertex[i]] = i;
    region.distance.push_back(search.distance(region.mesh_vertex[i]));
  }
  Points points(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    points.row(i) = mesh.vertices.row(region.mesh_vertex[i]);
    const CompressedRows::Row ring = adjacency.neighbours[region.mesh_vertex[i]];
    std::copy_if(ring.begin(), ring.end(), std::back_inserter(region.neighbours.values),
                 [&](int w) { return local[w] >= 0; });
    if (std::any_of(ring.begin(), ring.end(), [&](int w) { return local[w] < 0; })) {
      boundary.push_back(i);
    }
    std::for_each(region.neighbours.values.begin() + region.neighbours.offsets.back(), region.neighbours.values.end(),
                  [&](int& w) { w = local[w]; });
    region.neighbours.offsets.push_back(static_cast<int>(region.neighbours.values.size()));
  }
  region.faces.resize(mesh.faces.rows(), 3);
  Eigen::Index inside = 0;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::RowVector3i face(local[mesh.faces(f, 0)], local[mesh.faces(f, 1)], local[mesh.faces(f, 2)]);
    if ((face.array() >= 0).count() >= 2) {
      region.edge_faces.push_back(f);
    }
    if ((face.array() >= 0).all()) {
      region.faces.row(inside++) = face;
    }
  }
  region.faces.conservativeResize(inside, 3);

  const Adjacency local_faces = build_adjacency(region.size(), region.faces);
  GeodesicSearch from_boundary({region.neighbours, points, region.faces, local_faces.faces});
  const double width = spec.padding * region.max_distance;
  from_boundary.run(boundary, width);
  for (int i = 0; i < region.size(); ++i) {
    const bool at_boundary = std::binary_search(boundary.begin(), boundary.end(), i);
    const auto found = std::find(spec.anchors.vertices.begin(), spec.anchors.vertices.end(), region.mesh_vertex[i]);
    const auto kept = static_cast<std::size_t>(found - spec.anchors.vertices.begin());
    const bool is_kept = kept < spec.anchors.vertices.size();
    double depth = 0;
    if (is_kept) {
      depth = spec.anchors.depths[kept];
    } else if (given_set && spec.anchors.empty()) {
      depth = width > 0 ? 1 - from_boundary.distance(i) / width : 0;
    } else if (spec.kind == RegionSpec::Kind::Radius && spec.padding > 0) {
      depth = (region.distance[i] - (1 - spec.padding) * spec.radius) / (spec.padding * spec.radius);
    }
    const int group = group_of[region.mesh_vertex[i]];
    const bool anchor = group < 0 && (at_boundary || depth > kRoundedLength || is_kept);
    const double ratio = region.max_distance > 0 ? std::min(1.0, region.distance[i] / region.max_distance) : 1;
    region.group.push_back(group);
    region.classes.push_back(group >= 0 ? VertexClass::Handle : anchor ? VertexClass::Anchor : VertexClass::Free);
    region.anchor_depth.push_back(!anchor ? 0 : at_boundary ? 1 : std::min(depth, 1.0));
    region.anchor_weight.push_back(!anchor ? 0 : is_kept ? spec.anchors.weights[kept] : ratio);
  }
  region.anchored.assign(connected_components(region.neighbours, region.component), 0);
  for (int i = 0; i < region.size(); ++i) {
    region.anchored[region.component[i]] |= region.classes[i] == VertexClass::Anchor;
  }
  return region;
}

template <typename T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same_bits(const Region& a, const Region& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(same_bits(a.mesh_vertex, b.mesh_vertex));
  EXPECT_TRUE(same_bits(a.classes, b.classes));
  EXPECT_TRUE(same_bits(a.group, b.group));
  EXPECT_TRUE(same_bits(a.component, b.component));
  EXPECT_TRUE(same_bits(a.anchored, b.anchored));
  EXPECT_TRUE(same_bits(a.distance, b.distance));
  EXPECT_TRUE(same_bits(a.anchor_weight, b.anchor_weight));
  EXPECT_TRUE(same_bits(a.anchor_depth, b.anchor_depth));
  EXPECT_TRUE(same_bits(a.neighbours.offsets, b.neighbours.offsets));
  EXPECT_TRUE(same_bits(a.neighbours.values, b.neighbours.values));
  EXPECT_TRUE(same_bits(a.edge_faces, b.edge_faces));
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.max_distance, b.max_distance);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.left_out, b.left_out);
  EXPECT_EQ(a.mesh_vertices, b.mesh_vertices);
}

/// build_adjacency() by sorting.
inline Adjacency plain_adjacency(const TriangleMesh& mesh) {
  std::vector<std::set<int>> rings(mesh.vertices.rows()), around(mesh.vertices.rows());
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 9; ++k) {
      const int a = mesh.faces(f, k % 3), b = mesh.faces(f, k / 3);
      around[a].insert(f);
      if (a != b) {
        rings[a].insert(b);
      }
    }
  }
  const auto lists = [](const std::vector<std::set<int>>& rows) {
    CompressedRows result;
    for (const std::set<int>& row : rows) {
      result.values.insert(result.values.end(), row.begin(), row.end());
      result.offsets.push_back(static_cast<int>(result.values.size()));
    }
    return result;
  };
  return {lists(rings), lists(around)};
}

/// Compares a mesh's adjacency, and regions of each kind around handles, with bands, kept anchors and none; those with
/// a radius are as large as each fraction of all that the handles reach.
inline void expect_plain_regions(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups,
                                 const std::vector<double>& fractions, const std::vector<double>& paddings = {0, 0.1}) {
  const Adjacency adjacency = plain_adjacency(mesh);
  const Adjacency built = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  EXPECT_TRUE(same_bits(built.neighbours.offsets, adjacency.neighbours.offsets));
  EXPECT_TRUE(same_bits(built.neighbours.values, adjacency.neighbours.values));
  EXPECT_TRUE(same_bits(built.faces.offsets, adjacency.faces.offsets));
  EXPECT_TRUE(same_bits(built.faces.values, adjacency.faces.values));
  std::vector<int> handles;
  for (const std::vector<int>& group : groups) {
    handles.insert(handles.end(), group.begin(), group.end());
  }
  GeodesicSearch search({mesh, adjacency});
  const std::vector<int> reached = search.run(handles, kUnreached);
  RegionSpec set = given({});
  for (int v = static_cast<int>(mesh.vertices.rows()) - 1; v >= 0; --v) {  // with holes, and what no handle reaches
    if (mesh.vertices.row(v).allFinite() && (v % 37 != 5 || search.distance(v) == 0)) {
      set.vertices.push_back(v);
    }
  }
  set.vertices.insert(set.vertices.end(), set.vertices.begin(), set.vertices.begin() + 3);  // named twice
  RegionSpec kept = set;
  kept.anchors = anchors_of(plain_region(mesh, adjacency, set, groups));
  kept.anchors.reach *= 1.25;
  std::vector<RegionSpec> specs = {component(), kept};
  for (const double padding : paddings) {
    specs.push_back(given(set.vertices, padding));
    for (const double fraction : fractions) {
      const auto last = static_cast<std::size_t>(fraction * static_cast<double>(reached.size() - 1));
      specs.push_back(within(search.distance(reached[last]), padding));
    }
  }
  for (const RegionSpec& spec : specs) {
    const Region plain = plain_region(mesh, adjacency, spec, groups);
    for (const int threads : {1, 2, 3}) {
      SCOPED_TRACE(std::to_string(threads) + " threads, kind " + std::to_string(static_cast<int>(spec.kind)));
      expect_same_bits(build_region(mesh, adjacency, spec, groups, threads), plain);
    }
  }
}

}  // namespace lapedit::support
