// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_scene.h"

#include <algorithm>
#include <limits>

#include "lapedit/deform/edit_quality.h"
#include "lapedit/mesh/vertex_set.h"
#include "quality_measures.h"

namespace quality {
namespace {

double handle_behind(const Edit& edit, const lapedit::Points& after) {
  double error = 0, way = 0;
  for (std::size_t group = 0; group < edit.handles.size(); ++group) {
    for (const int v : edit.handles[group]) {
      const lapedit::Vector3 rest = edit.mesh.vertices.row(v).transpose(), now = after.row(v).transpose();
      const lapedit::Vector3 target = edit.maps[group] * rest;
      error = std::max(error, (now - target).norm());
      way = std::max(way, (target - rest).norm());
    }
  }
  return error / way;
}

/// Of all but handles, by the distance from these.
double far_movement(const Problem& scene, const lapedit::Points& after) {
  constexpr double kFar = 0.3;
  const lapedit::Region& region = scene.region;
  std::vector<std::pair<double, int>> others;  // negative distance
  double largest = 0;
  for (int i = 0; i < region.size(); ++i) {
    const int v = region.mesh_vertex[i], group = region.group[i];
    if (group >= 0) {
      const lapedit::Vector3 rest = scene.edit.mesh.vertices.row(v);
      largest = std::max(largest, (scene.edit.maps[static_cast<std::size_t>(group)] * rest - rest).norm());
    } else {
      others.emplace_back(-region.distance[i], v);
    }
  }
  std::sort(others.begin(), others.end());
  others.resize(std::max<std::size_t>(1, static_cast<std::size_t>(kFar * static_cast<double>(others.size()))));
  double sum = 0;
  for (const auto& [distance, v] : others) {
    sum += (after.row(v) - scene.edit.mesh.vertices.row(v)).norm();
  }
  return sum / static_cast<double>(others.size()) / largest;
}

}  // namespace

Problem::Problem(Edit given)
    : edit(std::move(given)),
      adjacency(lapedit::build_adjacency(static_cast<int>(edit.mesh.vertices.rows()), edit.mesh.faces)),
      region(lapedit::build_region(edit.mesh, adjacency, edit.region, edit.handles)) {}

Scene::Scene(Edit given)
    : Problem(std::move(given)),
      faces(region_faces(adjacency, region)),
      pairs(intersecting_pairs(edit.mesh.faces, faces, edit.mesh.vertices)),
      has_free_corner(static_cast<std::size_t>(edit.mesh.faces.rows()), 0) {
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == lapedit::VertexClass::Free) {
      for (const int f : adjacency.faces[region.mesh_vertex[i]]) {
        has_free_corner[f] = 1;
      }
    }
  }
}

Figures measure(const Scene& scene, const MethodResult& result) {
  const auto& [before, mesh_faces] = scene.edit.mesh;
  const lapedit::Points& after = result.positions;
  const std::vector<int>& vertices = scene.region.mesh_vertex;
  const lapedit::EdgeStretch stretch =
      lapedit::edge_stretch(scene.region, lapedit::gather(before, vertices), lapedit::gather(after, vertices));
  Figures figures;
  figures.rms = stretch.rms;
  figures.largest = stretch.largest;
  figures.behind = handle_behind(scene.edit, after);
  figures.flipped = flipped_triangles(scene.adjacency, mesh_faces, scene.faces, before, after);
  std::vector<std::pair<int, int>> pairs = intersecting_pairs(mesh_faces, scene.faces, after);
  pairs.erase(std::remove_if(
                  pairs.begin(), pairs.end(),
                  [&has = scene.has_free_corner](const auto& pair) { return !has[pair.first] && !has[pair.second]; }),
              pairs.end());
  figures.pairs = new_pairs(scene.pairs, pairs);
  const AreaStretch areas = area_stretch(mesh_faces, scene.faces, before, after);
  figures.area_rms = areas.rms;
  figures.shear = areas.shear;
  figures.worst = areas.worst;
  figures.tilt = detail_tilt(scene.adjacency, mesh_faces, vertices, before, after);
  figures.far = far_movement(scene, after);
  figures.twist = figures.asymmetry = std::numeric_limits<double>::quiet_NaN();
  if (const auto& spine = scene.edit.spine) {
    const Evenness even = evenness(spine->along, spine->from, spine->to, before, after);
    figures.twist = even.twist;
    figures.asymmetry = even.asymmetry;
  }
  figures.volume = scene.edit.height_field ? std::numeric_limits<double>::quiet_NaN()
                                           : volume_change(mesh_faces, scene.faces, before, after);
  figures.prepare_ms = result.prepare_ms;
  figures.solve_ms = result.solve_ms;
  figures.frame_ms = result.frame_ms;
  figures.fast_frame = result.fast_frame;
  return figures;
}

}  // namespace quality
