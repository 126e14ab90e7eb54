// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns the strength s of each of the region's links. A link holds two pieces together by a row s (x_a - x_b) below
/// those of M^k, whose right-hand side is s (R_a + R_b) / 2 (p_a - p_b). The rows of M^k leave residuals of some tenths
/// of an edge h, which pull a link off by a fraction of them over s^2. So with s^2 = 100 h / g, at least 100, a link of
/// length g changes by about a hundredth of its length.
/// @param rest  size() x 3
Eigen::VectorXd link_strengths(const Region& region, const Points& rest);

/// Returns the matrix with the rows of links below its own. @param strengths  none: the matrix itself
SparseMatrix with_link_rows(const SparseMatrix& matrix, const Region& region, const Eigen::VectorXd& strengths);

}  // namespace lapedit
