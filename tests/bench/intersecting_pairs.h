// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "lapedit/base/types.h"

namespace quality {

/// Pairs of faces that cut or touch each other elsewhere than in what they share, at least one of each pair among those
/// looked at: decided exactly, by CGAL's predicates. Lower number first, ascending. Faces without area are left out.
std::vector<std::pair<int, int>> intersecting_pairs(const lapedit::Faces& faces, const std::vector<int>& looked_at,
                                                    const lapedit::Points& positions);

/// How many pairs there are after that were not there before.
int new_pairs(const std::vector<std::pair<int, int>>& before, const std::vector<std::pair<int, int>>& after);

}  // namespace quality
