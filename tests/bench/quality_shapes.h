// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "lapedit/mesh/triangle_mesh.h"

/// Generated creatures to edit: deterministic, outward-facing, about as dense everywhere unless said otherwise.
namespace quality {

/// Surface where a function is zero, negative inside: surface nets on a grid of cubic cells, smoothed along the
/// surface. The function is to be smooth, with a slope of about 1 near its zeros.
lapedit::TriangleMesh level_set(const std::function<double(const lapedit::Vector3&)>& distance,
                                const lapedit::Vector3& low, const lapedit::Vector3& high, double cell);

/// Ball of radius 1 around the origin with a thin cupped ear on top, from z = 0.9 to 2.4, 0.1 thick and bent forwards.
lapedit::TriangleMesh head_with_ear(double cell);

/// An arm of length 4 along x with fist and, at x = 2, where it is 0.6 wide, an elbow, on a body of radius 1.2 around
/// (-1, 0, 0).
lapedit::TriangleMesh body_with_arm(double cell);

/// Shoulders below z = 0, a neck up to 1.2, a head of radius 0.8 around (0, 0, 1.8) with a snout towards -y.
lapedit::TriangleMesh bust(double cell);

/// A body around the origin and a tail of seven beads that rises behind it, its sting last.
lapedit::TriangleMesh body_with_tail(double cell, lapedit::Vector3& sting);

/// A figure that stands and looks to -y, from z = -1.7 to 1.9: its mesh is exactly its own mirror image in x.
lapedit::TriangleMesh symmetric_figure(double cell);

/// An animal that looks to +x, its four hooves below z = -1.6 at x = 0.9 and -0.9, y = 0.32 and -0.32.
lapedit::TriangleMesh quadruped(double cell);

/// A tube of radius 1 along x from 0 to 16, open at both ends: 16 vertices around up to x = 8, 64 beyond.
lapedit::TriangleMesh half_fine_tube();

/// A tube of radius 1 along x from 0 to 16, closed, with eight rows of bumps that are about as deep as wide.
lapedit::TriangleMesh tube_with_relief();

/// A face, open at its border: height over [-1.5, 1.5]^2 with a nose at (0, 0), of rows x columns vertices that are
/// spaced unevenly and shaken: sizes of triangles vary 30 times, many are obtuse.
lapedit::TriangleMesh uneven_face(int rows, int columns);

}  // namespace quality
