// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns the strength s of each of the region's links. A link holds two pieces together by a row s (x_a - x_b) = s t
/// below those of M^k. Here t is e = p_a - p_b rotated into the direction of (R_a + R_b) e. The rows of M^k leave
/// residuals of some tenths of an edge h, which change a link of length g by about as much over s^2. So s^2 = 1000
/// max(1, h / g), at most 10000, keeps the length of the link within a few hundredths. For higher orders the factor is
/// 100 instead of 1000.
/// @param rest  size() x 3
Eigen::VectorXd link_strengths(const Region& region, const Points& rest, int order);

/// Returns the matrix with the rows of links below its own. @param strengths  if empty, the result is the matrix itself
SparseMatrix with_link_rows(const SparseMatrix& matrix, const Region& region, const Eigen::VectorXd& strengths);

}  // namespace lapedit
