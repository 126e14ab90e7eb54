// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// Returns the values of a scan at its points that are nearest to others, as after a fit.
/// @param scan  a mesh, or points without faces; points that are not finite are left out
/// @param values  one row per vertex of the scan; between vertices they are linear
/// @param within  up to which distance, model units; none: 2 % of the scan's size
/// @return one row per point, NaN where the scan is farther away
/// @throws EditError (BadParameter) for another number of rows, or a scan without finite points. O(n log n)
Eigen::MatrixXd carry_over(const TriangleMesh& scan, const Eigen::MatrixXd& values, const Points& at,
                           std::optional<double> within = {});

}  // namespace lapedit
