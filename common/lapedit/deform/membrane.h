// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/edit_settings.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// What stretching costs beside bending: the energy of an edit is |M x|^2 + c x^T L x, M = D^-1 L the operator and L
/// its stiffness matrix, sum_ij w_ij |x_i - x_j|^2 / 2. With M about h^2 / 4 times the surface's Laplacian, h the mean
/// edge,
///
///     c = settings.membrane / s^2 * (h^2 / 4) / mean D
///
/// makes the ratio of the two energies membrane / s^2 whatever the triangulation, s the region's size: sqrt(2) times
/// the root mean square distance from the centroid, a disc's radius. Stretching then spreads over all of the region but
/// for a length of s / sqrt(membrane) around handles and rim, where bending keeps it smooth. That length is never less
/// than half an edge, so that handles arrive in coarse regions too. Neither handle nor anchors enter, so that the next
/// handle finds the factor ready. Source: M. Botsch, O. Sorkine, On linear variational surface deformation methods,
/// TVCG 2008, section 3.
/// @param rest      size() x 3
/// @param mean_sum  of the rows' weights
/// @return          c; 0 without a membrane
double membrane_factor(const EditSettings& settings, const Region& region, const Points& rest, double mean_sum);

}  // namespace lapedit
