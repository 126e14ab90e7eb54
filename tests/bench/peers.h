// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "quality_scene.h"

/// Other tools. Each makes the edit of a problem. @throws std::runtime_error if there is no result
namespace quality {

constexpr int kArapIterations = 10, kManyArapIterations = 100;

/// CGAL's Surface_mesh_deformation with its defaults: the region is its region of interest, handles and anchors are its
/// control vertices. A frame is one iteration. Faces that make the mesh no manifold are skipped.
MethodResult arap(const Problem& scene, int iterations = kArapIterations);
/// The same with rotations that are smoothed among neighbours (SR-ARAP).
MethodResult smooth_arap(const Problem& scene);

/// Smooth ARAP of Oehri, Herholz, Sorkine-Hornung 2025 with their interactive setting, written from the paper.
MethodResult oehri_arap(const Problem& scene);

/// libigl's ARAP and biharmonic displacement, where its headers are given.
MethodResult igl_arap(const Problem& scene);
MethodResult igl_biharmonic(const Problem& scene);

/// Blender's Laplacian Deform modifier in a process of its own, times less the cost of updates without it.
MethodResult blender(const Problem& scene);

}  // namespace quality
