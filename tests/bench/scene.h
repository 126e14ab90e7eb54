// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

namespace speed {

/// What ours and the peers get alike: a mesh, a handle, a region with its
/// anchors.
struct Scene {
  lapedit::TriangleMesh mesh;
  lapedit::Adjacency adjacency;
  lapedit::RegionSpec spec;
  std::vector<std::vector<int>> handle;
  lapedit::Region region;

  int handle_vertex() const { return handle[0][0]; }
  std::vector<int> anchors() const;  ///< mesh vertex numbers
};

/// A disc of radius 1 with exactly so many vertices, all of them in the region:
/// irregular in place and valence, with smooth bumps and ripples a few edges
/// long; numbered in coherent strips that come in any order.
Scene make_scene(int vertices);

/// Where the handle is in a frame: never twice the same place.
lapedit::Affine handle_move(int frame);

/// For a peer in another process, all in the machine's own byte order: int32
/// vertices, faces, anchors, handle; then the vertices as doubles, the faces
/// and the anchors as int32. @throws std::runtime_error
void write_scene(const Scene& scene, const std::string& path);

}  // namespace speed
