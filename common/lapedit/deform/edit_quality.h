// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/edit_constraints.h"

namespace lapedit {

// How good an edit is, in numbers. These functions only read.

/// Of |after| / |before| - 1 over the region's edges: RMS, and the largest above 0. Edges without length are left out.
struct EdgeStretch {
  double rms = 0, largest = 0;
};
EdgeStretch edge_stretch(const Region& region, const Points& before, const Points& after);

/// Faces whose normal turned by more than 90 degrees against the mean of its corners' rotations; degenerate ones are
/// left out.
int flipped_triangles(const Region& region, const Points& before, const Points& after,
                      const std::vector<Matrix3>& rotations);

/// Angles of rotations, degrees.
struct RotationAngles {
  double mean = 0, largest = 0;
};
RotationAngles rotation_angles(const std::vector<Matrix3>& rotations);

/// Largest distances, model units: of a handle vertex's target from its place at rest, of a handle vertex from its
/// target, of an anchor from its place.
struct ConstraintResiduals {
  double handle_displacement = 0, handle = 0, anchor = 0;
};
/// @param displacement  from the carried pose, size() x 3
ConstraintResiduals constraint_residuals(const LaplacianSystem& system, const EditConstraints& constraints,
                                         const Points& displacement);

}  // namespace lapedit
