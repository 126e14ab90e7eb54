// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// A deformation without a solve: each vertex follows each handle group's map with a weight that falls off with
/// geodesic distance,
///
///     phi_g = d_g^-3/2 / (a^-3/2 + sum_k d_k^-3/2)
///
/// where d_k is the distance from handle group k, and a the distance from the anchors, along the region's edges. phi_g
/// is 1 on group g, 0 on the other groups and on the anchors, with zero slope at both. The groups' weights sum to 1 in
/// components without anchors. Source: D. Shepard 1968, inverse distances.
struct GeodesicFalloff {
  Eigen::MatrixXd weights;  ///< phi, size() x groups
  std::vector<int> lone;    ///< the only local vertex of a group of one, which has a displacement only; else -1

  bool empty() const { return lone.empty(); }
};

/// @param points  size() x 3
/// Cost: one search through the region per group, and one for the anchors.
GeodesicFalloff geodesic_falloff(const Region& region, const Points& points);

}  // namespace lapedit
