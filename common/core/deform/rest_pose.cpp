// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/rest_pose.h"

#include <algorithm>
#include <utility>

#include "lapedit/base/error.h"

namespace lapedit {

RestPose::RestPose(const TriangleMesh& mesh, std::shared_ptr<const Region> with)
    : region(std::move(with)), world(region->size(), 3), local(region->size(), 3) {
  const auto handle = std::find(region->classes.begin(), region->classes.end(), VertexClass::Handle);
  const auto first = handle == region->classes.end() ? 0 : handle - region->classes.begin();
  origin = mesh.vertices.row(region->mesh_vertex[first]).transpose();
  for (int i = 0; i < region->size(); ++i) {
    world.row(i) = mesh.vertices.row(region->mesh_vertex[i]);
    local.row(i) = world.row(i) - origin.transpose();
  }
}

}  // namespace lapedit
