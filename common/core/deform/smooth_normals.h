// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// The smoothing of the paper's section 6 as a linear map over a region. Row i is the weighted mean over the vertices
/// within geodesic distance r of vertex i, with the weight p(t) = 2 t^3/r^3 - 3 t^2/r^2 + 1; rows sum to 1. Distances
/// and weights are those of the rest shape, so one object serves all poses of a region.
///
/// If the neighbourhoods together would hold more than max_entries vertices, means are computed at sample centres r/4
/// to r/2 apart and blended by the kernel of radius r/2. Cost and memory then do not grow with r, and the smoothing is
/// slightly wider. On symmetric meshes the centres depend on the vertex numbers.
class SmoothingKernel {
 public:
  /// @param rest     size() x 3 rest positions of the region
  /// @param radius   r > 0, model units
  SmoothingKernel(const Region& region, const Points& rest, double radius, int threads = 0,
                  std::size_t max_entries = 8000000);

  /// Computes the weighted means, size() x 3. @param scratch  keeps its storage between calls
  void apply(const Points& in, Points& out, Points& scratch) const;

  /// Returns whether means are computed at sample centres.
  bool sampled() const { return !blend_.columns.empty(); }

 private:
  struct Rows {  // sparse rows, normalised
    std::vector<std::size_t> offsets{0};
    std::vector<int> columns;
    std::vector<double> weights;
  };
  static void multiply(const Rows& rows, const Points& in, Points& out);

  Rows direct_;  // vertices x vertices, or centres x vertices when sampled
  Rows blend_;   // vertices x centres when sampled, else empty
};

/// Returns the radius for normal_radius = 0: 0.3 of the largest distance from a handle in the region, at least four
/// mean edges.
///
/// An edit bends a region on the scale of its size, so clearly smaller features are detail and should rotate as a
/// whole. Below 0.2 the bumps of a grid tilt more and pulled limbs stretch more; above 0.4 limbs lose their own detail.
double automatic_normal_radius(const Region& region, const Points& rest);

}  // namespace lapedit
