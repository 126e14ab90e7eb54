// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/edit_report.h"
#include "lapedit/deform/laplacian_system.h"
#include "lapedit/mesh/surface_measures.h"

namespace lapedit {

// Measures of the quality of an edit. These functions only read.

/// Fits rotations to edges and normals of the surface, averaged over some rings and faded out across the anchor band.
/// They are independent of the rotations of differential coordinates. Cost: O(edges).
std::vector<Matrix3> surface_rotations(const Region& region, const Points& before, const Points& after,
                                       ThreadPool& pool);

/// Returns the remaining fraction of the detail's height h = n . (p - S p): sum h' h / sum h^2 over the free vertices,
/// where n are the normals of the smooth surface S p. A ratio of the two heights would also count curvature that the
/// edit adds (lifted grid of detail_orientation_test: 1.14 where 0.98 of the bumps' height is kept; this function
/// returns 0.985). `std::nullopt` without detail, and with other methods than EditMethod::Paper. Cost: two smoothings.
std::optional<double> detail_height(const LaplacianSystem& system, const Points& after);

/// Returns the largest angle in degrees between the rotations r[i] and s[i]; an empty `s` stands for identities.
/// @param at  out, unless null: the index i of the largest angle; -1 if all are 0
double largest_rotation(const std::vector<Matrix3>& r, const std::vector<Matrix3>& s, int* at = nullptr);

/// Computes all figures except the normal equations' residual, the height of detail, the rotation left by passes, and
/// new intersections.
/// @param positions  the result as the mesh stores it, size() x 3
EditQuality edit_quality(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                         const std::vector<Matrix3>& rotations);

}  // namespace lapedit
