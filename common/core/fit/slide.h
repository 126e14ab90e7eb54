// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/edit_report.h"

namespace lapedit {

/// A fit over the template's size: positions before and after it, normals after it, and which vertices the scan draws.
struct FittedShape {
  const Points &before, &after, &normals;
  const std::vector<char>& drawn;
};

/// Compares a fit with the most probable smooth deformation that has the same displacements across the surface, where
/// the scan draws it. Where the two differ along the surface, the template is free to slide. Source: M. Luethi et al.,
/// Gaussian Process Morphable Models, PAMI 2018, with a Gaussian kernel as wide as the template.
/// @param samples  vertices, spread over the surface: three of five serve to predict the others
/// @param met      vertices whose displacements are known in all directions
/// @return lengths over the template's size. O(samples^3)
FitSlide slide_of(const FittedShape& fit, const std::vector<int>& samples, const std::vector<int>& met);

}  // namespace lapedit
