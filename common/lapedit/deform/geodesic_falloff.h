// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// A constrained deformation without a solution: each vertex goes along with each handle group's map by a weight that
/// falls off with geodesic distance,
///
///     phi_g = d_g^-3/2 / (a^-3/2 + sum_k d_k^-3/2),  d_k the distance from handle group k, a that from the anchors
///
/// along the region's edges. phi_g is 1 on group g, 0 on the other groups and on the anchors, and has no slope at
/// either; the sum over the groups is 1 where no anchor is in reach. Source: D. Shepard 1968, inverse distances.
struct GeodesicFalloff {
  Eigen::MatrixXd weights;  ///< phi, size() x groups
  std::vector<int> lone;    ///< the local vertex of a group that has but one and so only a way to give; else -1

  bool empty() const { return lone.empty(); }
};

/// @param points  size() x 3
/// Cost: a search through the region for each group, and one for the anchors.
GeodesicFalloff geodesic_falloff(const Region& region, const Points& points);

}  // namespace lapedit
