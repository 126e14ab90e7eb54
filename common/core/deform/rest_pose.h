// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "lapedit/mesh/region.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {

/// A region with its handles, and the positions of its vertices before an edit. All objects that pose the region share
/// it.
struct RestPose {
  std::shared_ptr<const Region> region;
  Vector3 origin = Vector3::Zero();  ///< the first handle vertex, or the first of a region without a handle
  Points world;                      ///< as given, size() x 3
  Points local;                      ///< relative to `origin`, so that no digits are lost far from zero

  /// @param mesh  not kept after construction
  RestPose(const TriangleMesh& mesh, std::shared_ptr<const Region> with)
      : region(std::move(with)), world(gather(mesh.vertices, region->mesh_vertex)) {
    const auto handle = std::find(region->classes.begin(), region->classes.end(), VertexClass::Handle);
    const auto first = handle == region->classes.end() ? 0 : handle - region->classes.begin();
    origin = world.row(first).transpose();
    local = world.rowwise() - origin.transpose();
  }
};

}  // namespace lapedit
