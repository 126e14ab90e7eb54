// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/edit_constraints.h"

namespace lapedit {

/// Scratch memory of rotate_coordinates().
struct RotatedCoordinates {
  Points rotated, product, with_links;
};

/// Rotates the differential coordinates (step 3 of the paper's section 4): right = constraints + ((M^k)^T + c D)
/// M^(k-1) (R - I) delta, where k is the order and c D that of the membrane. EditMethod::Paper rotates whole
/// coordinates, R_i delta_i; EditMethod::Default each edge by the mean of its ends' rotations, so that flat parts of
/// the surface bend too, and limbs keep their thickness.
/// @param rotations  R_i, one per vertex, relative to the rigidly moved pose
/// @param right      out, size() x 3
/// Cost: O(edges). Nothing is allocated after the first call.
void rotate_coordinates(const LaplacianSystem& system, const EditConstraints& constraints,
                        const std::vector<Matrix3>& rotations, RotatedCoordinates& scratch, Points& right);

}  // namespace lapedit
