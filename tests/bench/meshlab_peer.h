// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "quality_scene.h"

namespace quality {

/// What comes nearest among MeshLab's own filters: the distance along the surface from a point in each vertex's quality
/// ("Colorize by geodesic distance from a given point"), then the handle's way with a smooth fall-off of it, to 0 where
/// the nearest anchor is ("Per Vertex Geometric Function"), by meshlabserver. It has no times.
/// @throws std::runtime_error if the handle is no single vertex that is moved without a turn, or there is no result
MethodResult meshlab_falloff(const Scene& scene);

}  // namespace quality
