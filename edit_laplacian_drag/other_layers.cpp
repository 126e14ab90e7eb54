// SPDX-License-Identifier: GPL-3.0-or-later
#include "other_layers.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "lapedit_host/mesh_bridge.h"

using namespace lapedit;
using namespace lapedit::host;

void OtherLayers::read(const std::vector<Layer>& layers, int edited) try {
  if (auto built = building_.take()) {
    targets_ = std::move(*built);
  }
  const auto own = std::find_if(layers.begin(), layers.end(), [edited](const Layer& l) { return l.id == edited; });
  if (own == layers.end()) {
    return;
  }
  std::vector<double> found;
  std::vector<std::pair<const CMeshO*, Affine>> others;  // with the map to the edited layer's coordinates
  for (const Layer& layer : layers) {
    if (layer.visible && layer.id != edited) {
      others.emplace_back(layer.mesh, Eigen::Matrix4d(own->transform.inverse() * layer.transform));
      const Affine& map = others.back().second;
      found.insert(found.end(), {double(layer.id), double(layer.mesh->vn), double(layer.mesh->fn)});
      found.insert(found.end(), map.data(), map.data() + map.matrix().size());
    }
  }
  if ((busy() || targets_) && found == fingerprint_) {
    return;
  }
  forget();
  fingerprint_ = std::move(found);
  std::vector<TriangleMesh> meshes;
  for (const auto& [mesh, map] : others) {
    meshes.push_back(read_mesh(*mesh).mesh);
    Points& points = meshes.back().vertices;
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      points.row(v) = (map * Vector3(points.row(v))).transpose();
    }
  }
  building_.start([given = std::move(meshes)]() mutable {
    std::vector<TriangleMesh> usable;
    for (TriangleMesh& mesh : given) {
      if (mesh.faces.rows() > 0 && mesh.faces.minCoeff() >= 0) {
        usable.push_back(std::move(mesh));
      }
    }
    return std::make_shared<const SnapTargets>(std::move(usable));
  });
} catch (const std::bad_alloc&) {
  fail("There is not enough memory to snap to the other layers: hide some, or switch snapping off.");
} catch (const std::exception& exception) {
  fail(exception.what());
}

void OtherLayers::fail(const std::string& sentence) {
  targets_ = std::make_shared<const SnapTargets>(std::vector<TriangleMesh>());
  throw std::runtime_error(sentence);
}

void OtherLayers::forget() {
  targets_ = nullptr;
  building_.cancel();
}
