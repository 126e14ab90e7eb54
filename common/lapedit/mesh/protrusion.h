// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {

/// Returns the radius at which a disc on the surface stops being a protrusion such as an ear, a nose or a limb, model
/// units; 0 if it is none. With L the length of its border and A its area, L^2 / (4 pi A) is 1 in the plane, falls
/// while the disc covers a protrusion, and rises where the disc spreads over what that stands on: the first such neck
/// counts. A disc of more than a quarter of its piece is a trunk and not a protrusion.
/// @param search    from the middle, up to the largest radius. @param reached  its result, nearest first
/// @param smallest  necks nearer than this are details
/// @param whole     area of the piece
/// Cost: O(what is reached).
double protrusion_radius(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search,
                         const std::vector<int>& reached, double smallest, double largest, double whole);

}  // namespace lapedit
