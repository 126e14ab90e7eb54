// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers.h"

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "quality_files.h"

namespace quality {
namespace {

using nlohmann::json;

/// Blender has absolute bounds: what is tiny in its units it leaves out.
double blender_scale(const Problem& scene) {
  const lapedit::Region& region = scene.region;
  double length = 0;
  for (int i = 0; i < region.size(); ++i) {
    for (const int j : region.neighbours[i]) {
      length +=
          (scene.edit.mesh.vertices.row(region.mesh_vertex[i]) - scene.edit.mesh.vertices.row(region.mesh_vertex[j]))
              .norm();
    }
  }
  return 0.1 * static_cast<double>(region.neighbours.values.size()) / length;
}

json scene_json(const Problem& scene, double scale) {
  const lapedit::Region& region = scene.region;
  json vertices = json::array(), faces = json::array(), anchors = json::array(), groups = json::array();
  for (const lapedit::Affine& map : scene.edit.maps) {
    json rows = json::array();
    for (int i = 0; i < 3; ++i) {
      rows.push_back({map(i, 0), map(i, 1), map(i, 2), scale * map(i, 3)});
    }
    groups.push_back({{"map", rows}, {"vertices", json::array()}});
  }
  for (int i = 0; i < region.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      vertices.push_back(scale * scene.edit.mesh.vertices(region.mesh_vertex[i], k));
    }
    if (region.classes[i] == lapedit::VertexClass::Anchor) {
      anchors.push_back(i);
    } else if (region.classes[i] == lapedit::VertexClass::Handle) {
      groups[region.group[i]]["vertices"].push_back(i);
    }
  }
  for (const auto& face : region.faces.rowwise()) {
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) {
      faces.insert(faces.end(), {face[0], face[1], face[2]});
    }
  }
  return {{"vertices", vertices}, {"faces", faces}, {"anchors", anchors}, {"groups", groups}};
}

}  // namespace

MethodResult blender(const Problem& scene) {
  const ScratchFolder folder("blender");
  const std::filesystem::path input = folder.path / "scene.json", output = folder.path / "result.json";
  const double scale = blender_scale(scene);
  std::ofstream(input) << scene_json(scene, scale);
  // A spinning OpenMP thread would slow it tenfold as soon as something else runs.
  const std::string command = "OMP_WAIT_POLICY=passive HOME='" + folder.path.string() +
                              "' blender -b --factory-startup -noaudio --python-exit-code 1 --python '" +
                              QUALITY_BLENDER_SCRIPT + "' -- '" + input.string() + "' '" + output.string() + "' >'" +
                              (folder.path / "log").string() + "' 2>&1 </dev/null";
  if (std::system(command.c_str()) != 0 || !std::filesystem::exists(output)) {
    throw std::runtime_error("Blender has no result");
  }
  const json given = json::parse(std::ifstream(output));
  const std::vector<double> positions = given["positions"];
  if (positions.size() != 3 * static_cast<std::size_t>(scene.region.size())) {
    throw std::runtime_error("Blender's result has another number of vertices");
  }
  MethodResult result;
  result.positions = scene.edit.mesh.vertices;
  const Eigen::Map<const lapedit::Points> deformed(positions.data(), scene.region.size(), 3);
  for (int i = 0; i < scene.region.size(); ++i) {
    result.positions.row(scene.region.mesh_vertex[i]) = deformed.row(i) / scale;
  }
  result.prepare_ms = given["bind_ms"];
  result.solve_ms = given["update_ms"];
  result.frame_ms = result.solve_ms;
  return result;
}

}  // namespace quality
