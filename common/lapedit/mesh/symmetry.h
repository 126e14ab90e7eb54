// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A plane that shapes are mirrored across.
struct MirrorPlane {
  Vector3 point = Vector3::Zero();    ///< any of its points, model units
  Vector3 normal = Vector3::UnitX();  ///< any length but zero
};

/// Returns the map S: x -> x - 2 n n . (x - p). @throws EditError (NotFinite, BadParameter)
Affine reflection(const MirrorPlane& plane);

/// The plane that the mesh is most nearly its own mirror image across; `std::nullopt` if its vertices' mirrored places
/// are farther from the surface's vertices than 1 % of the bounding box's diagonal in the mean. Tried are the planes
/// across the coordinate axes, which win if they are as good, and across the axes of inertia, each through the centre
/// of the box and through the centroid; the best are refined. Deterministic. Cost: O(vertices), some 0.1 s for 100,000.
std::optional<MirrorPlane> find_symmetry(const TriangleMesh& mesh);

}  // namespace lapedit
