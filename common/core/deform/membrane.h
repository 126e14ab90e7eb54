// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/edit_settings.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns h^2, the squared edge length of an equilateral mesh whose vertices have this mean area.
inline double squared_spacing(double mean_area) {
  return 1.1547005383792515 * mean_area;  // 2 / sqrt(3)
}

/// The mean of D on an even mesh with LaplacianKind::Surface.
constexpr double kMeanDivisor = 4;

/// Returns the cost c of stretching against bending. The energy of an edit is |M x|^2 + c x^T L x, where M = D^-1 L is
/// the operator and L its stiffness matrix, symmetric positive semidefinite: x^T L x = sum_ij w_ij |x_i - x_j|^2 / 2.
/// Since M is about h^2 / 4 times the surface's Laplacian,
///
///     c = settings.membrane / s^2 * (h^2 / 4) / mean D
///
/// makes the ratio of the two energies membrane / s^2 for any triangulation. s is the region's size: sqrt(2) times the
/// root mean square distance from the centroid, by area, which is the radius of a disc. Stretching then spreads over
/// the whole region except a length of s / sqrt(membrane) around handles and boundary, where bending keeps the surface
/// smooth. That length is at least half an edge, so that handles reach their targets in coarse regions too. Neither
/// handle nor anchors enter, so the next handle can reuse the factor. Source: M. Botsch, O. Sorkine, On linear
/// variational surface deformation methods, TVCG 2008, section 3.
/// @param rest  size() x 3
/// @param mean  mean of D
/// @return      c; 0 without a membrane or an area
double membrane_factor(const EditSettings& settings, const Region& region, const Points& rest, double mean);

}  // namespace lapedit
