// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {

/// Computes the line on the surface where a search's distance equals a radius, straight through each face.
/// @param reached   the vertices that the search has reached, nearest first
/// @param segments  out: two rows, the end points, per segment
/// @param scratch   keeps its memory between calls
/// Cost: O(vertices within the radius).
void distance_contour(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search, double radius,
                      const std::vector<int>& reached, std::vector<double>& scratch, Points& segments);

}  // namespace lapedit
