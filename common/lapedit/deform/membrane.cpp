// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/membrane.h"

#include <algorithm>
#include <cmath>

namespace lapedit {

double membrane_factor(const EditSettings& settings, const Region& region, const Points& rest, double mean_sum) {
  const int n = region.size();
  if (settings.membrane == 0 || region.neighbours.values.empty() || !(mean_sum > 0)) {
    return 0;
  }
  Vector3 centroid = Vector3::Zero();
  for (int i = 0; i < n; ++i) {
    centroid += rest.row(i).transpose() / n;
  }
  double edges = 0, spread = 0;
  for (int i = 0; i < n; ++i) {
    spread += (rest.row(i).transpose() - centroid).squaredNorm();
    for (const int j : region.neighbours[i]) {
      edges += (rest.row(i) - rest.row(j)).norm();
    }
  }
  const double edge = edges / static_cast<double>(region.neighbours.values.size());
  const double squared_size = 2 * spread / n;
  const double factor = std::min(settings.membrane * (edge * edge / 4) / squared_size, 1.0) / mean_sum;
  return std::isfinite(factor) ? factor : 0;
}

}  // namespace lapedit
