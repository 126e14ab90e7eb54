// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/triangle_mesh.h"

/// Generated meshes with limbs and features to drag: closed, evenly meshed, y upwards; deterministic.
namespace lapedit::shapes {

/// A head that looks to +z, about 2.6 high: nose tip near (0, -0.13, 1.2), ears at x = 1 and -1.
/// @param spacing  approximate distance between vertices
TriangleMesh head(double spacing = 0.03);

/// A right hand with its fingers to +y in the plane z = 0, about 2.6 high; tip of the middle finger near (0.05, 1.6,
/// 0).
TriangleMesh hand();

/// A creature on four legs that looks to +x, about 4.3 long: tips of a horn near (1.28, 1.95, 0.3), of an ear near
/// (1.2, 1.2, 0.62), of the tail near (-2.2, 0.6, 0); a front foot near (0.75, -1.35, 0.3).
TriangleMesh creature();

/// A dragon with scales on four legs that looks to +x, about 7 long: snout near (3.2, 0.5, 0), tip of the tail near
/// (-3.6, -0.3, 0). Its vertices are numbered by x, from the tail on.
TriangleMesh dragon();

/// A person who stands and looks to +z, about 3.5 high, arms hanging away from the body: nose tip near (0, 1.39, 0.47),
/// shoulders at x = 0.4 and -0.4, y = 0.8, fingertips near (1.08, -0.4, 0.1) and its mirror image.
TriangleMesh person();

}  // namespace lapedit::shapes
