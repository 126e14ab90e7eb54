// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/deform/edit_constraints.h"

namespace lapedit {

// How good an edit is, in numbers. These functions only read.

/// Of |after| / |before| - 1 over the region's edges: RMS, and the largest above 0. Edges without length are left out.
struct EdgeStretch {
  double rms = 0, largest = 0;
  int at = -1;  ///< the lower end of the edge with the largest, a vertex of the region; -1: none became longer
};
EdgeStretch edge_stretch(const Region& region, const Points& before, const Points& after);

/// Faces whose normal turned by more than 90 degrees against the mean of its corners' rotations; degenerate ones are
/// left out.
int flipped_triangles(const Region& region, const Points& before, const Points& after,
                      const std::vector<Matrix3>& rotations);

/// R_i fitted to the surface itself, as SmoothSurface fits them to the smoothed one: what a triangle's normal turned
/// by on the scale of some rings, whatever details were turned by. O(edges).
std::vector<Matrix3> surface_rotations(const Region& region, const Points& before, const Points& after,
                                       ThreadPool& pool);

/// Of the cones from the border's centroid to the faces, each component for itself, positive within the normals: what
/// the faces enclose where they are closed. A motion of the whole does not change it; where the border stays, its
/// change is that of the body whose surface this is. O(faces).
double enclosed_volume(const Region& region, const Points& positions);

/// Share of the detail's height h = n . (p - S p) that is found again: sum h' h / sum h^2 over the free vertices, n the
/// normals of the smooth surface S p. Curvature that the edit adds falls out, which a ratio of the two heights would
/// count (grid of detail_orientation_test, lifted: 1.14 where 0.98 of the bumps' height is kept; this says 0.985).
/// Nothing where there is no detail, or no smoother. Cost: two smoothings.
std::optional<double> detail_height(const LaplacianSystem& system, const Points& after);

/// Largest angle between R_i and S_i, degrees; S empty: from no rotation.
double largest_turn(const std::vector<Matrix3>& r, const std::vector<Matrix3>& s);

/// All of it but the normal equations' residual, the height of detail, what passes leave and what hosts count.
/// @param positions  the result as it is stored, size() x 3
EditQuality edit_quality(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                         const std::vector<Matrix3>& rotations);

}  // namespace lapedit
