// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/cells/region_cells.h"

namespace lapedit {

/// Computes RegionCells::curvature and metric: for each cell a symmetric matrix of determinant 1. Along the surface,
/// lengths are up to 1.26 times shorter in the direction of the largest curvature and longer across it. Curvature is
/// that of the cells, so details have none. This makes limbs stiff around their axis, so that they stay round when they
/// are bent or twisted. On flat and on round surfaces all matrices are the identity.
/// @param size  the region's, see size_of(). Cost: O(cells).
void measure_metric(double size, RegionCells& cells);

/// Returns the metric of each vertex of a region, blended from cells that depend on neither handles nor anchors.
/// Cost: O(edges).
std::vector<Matrix3> surface_metric(const Region& region, const Points& rest, ThreadPool& pool);

}  // namespace lapedit
