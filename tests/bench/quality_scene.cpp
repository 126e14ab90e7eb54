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
  figures.dihedral = dihedral_change(mesh_faces, scene.faces, before, after);
  figures.volume = scene.edit.height_field ? std::numeric_limits<double>::quiet_NaN()
                                           : volume_change(mesh_faces, scene.faces, before, after);
  figures.prepare_ms = result.prepare_ms;
  figures.solve_ms = result.solve_ms;
  figures.frame_ms = result.frame_ms;
  figures.fast_frame = result.fast_frame;
  return figures;
}

}  // namespace quality
