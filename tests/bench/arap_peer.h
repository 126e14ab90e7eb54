// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "quality_scene.h"

namespace quality {

constexpr int kArapIterations = 10, kManyArapIterations = 100;

/// CGAL's Surface_mesh_deformation with its defaults: the region is its region of interest, the handles and all
/// stationary anchors are its control vertices. A frame is one iteration. Faces that make the mesh no manifold are
/// left out.
/// @throws std::runtime_error if CGAL cannot factorise its matrix
MethodResult arap(const Scene& scene, int iterations = kArapIterations);

/// The same with rotations that are smoothed among neighbours (SR-ARAP).
MethodResult smooth_arap(const Scene& scene);

}  // namespace quality
