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

/// All of it but the normal equations' residual.
/// @param positions  the result as it is stored, size() x 3
EditQuality edit_quality(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                         const std::vector<Matrix3>& rotations);

}  // namespace lapedit
