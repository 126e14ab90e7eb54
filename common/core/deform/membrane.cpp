// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/membrane.h"

#include <algorithm>
#include <cmath>

#include "lapedit/mesh/surface_index.h"

namespace lapedit {

double membrane_factor(const EditSettings& settings, const Region& region, const Points& rest, double mean) {
  if (settings.membrane == 0 || region.faces.rows() == 0 || !(mean > 0)) {
    return 0;
  }
  const SurfaceSize surface = size_of(rest, region.faces);
  const double squared_h = squared_spacing(face_areas(rest, region.faces).sum() / region.size());
  const double factor = std::min(settings.membrane * (squared_h / 4) / (surface.size * surface.size), 1.0) / mean;
  return std::isfinite(factor) ? factor : 0;
}

}  // namespace lapedit
