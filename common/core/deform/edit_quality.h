// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

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

/// Returns the largest angle in degrees between the rotations r[i] and s[i]; an empty `s` stands for identities.
/// @param at  out, unless null: the index i of the largest angle; -1 if all are 0
double largest_rotation(const std::vector<Matrix3>& r, const std::vector<Matrix3>& s, int* at = nullptr);

/// Measures stretch, flipped and folded triangles and volume.
/// @param rotations  of the details, one per vertex
void measure_shape(const Region& region, const Points& before, const Points& after,
                   const std::vector<Matrix3>& rotations, ThreadPool& pool, EditReport& report);

/// Measures the shape, and residuals, rotations and causes of advice, but not the rotation left by passes.
/// @param positions  the result as the mesh stores it, size() x 3
void measure_edit(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                  const std::vector<Matrix3>& rotations, EditReport& report);

}  // namespace lapedit
