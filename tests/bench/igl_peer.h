// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "quality_scene.h"

namespace quality {

/// libigl's arap_solve() with its defaults, of the region alone: handles and stationary anchors, and what has no face,
/// are held hard. A frame is one of as many iterations as CGAL gets.
/// @throws std::runtime_error if libigl cannot factorise its matrix
MethodResult igl_arap(const Scene& scene);

/// libigl's harmonic() with k = 2: the biharmonic displacement of the same constraints. A frame is a solution.
/// @throws std::runtime_error if libigl cannot factorise its matrix
MethodResult igl_biharmonic(const Scene& scene);

}  // namespace quality
