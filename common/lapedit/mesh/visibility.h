// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/camera.h"
#include "lapedit/mesh/ray_cast.h"

namespace lapedit {

/// Answers many questions of what a viewer sees of one pose of a mesh.
class Visibility {
 public:
  /// Builds a tree of boxes over the faces. O(faces log faces). The mesh must outlive the object and stay as it is.
  explicit Visibility(const TriangleMesh& mesh);
  ~Visibility();

  /// Whether a viewer sees a vertex: from the near plane to the vertex, the line between them meets no part of the mesh
  /// but the faces at the vertex, and at least one of these shows the given side. The window's borders do not count.
  /// @param side  1: the outside of the faces, -1: their inside
  /// O(log faces).
  bool sees(const Camera& view, const Adjacency& adjacency, int vertex, int side = 1) const;

  /// As first_hit() of the mesh, O(log faces).
  std::optional<SurfaceHit> first_hit(const Ray& ray) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The vertices within a distance along the surface of a hit that are visible, from the side that was hit, and reached
/// over visible vertices only: a brush of that radius does not touch what lies behind. Ascending; empty if hit.vertex
/// itself is hidden.
std::vector<int> brushed_vertices(const TriangleMesh& mesh, const Adjacency& adjacency, const Visibility& visibility,
                                  const Camera& view, const SurfaceHit& hit, double radius);

}  // namespace lapedit
