// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns a painted region before its distances are known, with its rim as anchors. O(region).
Region painted_region(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                      const std::vector<std::vector<int>>& groups);

/// Returns the number of vertices in pieces that a single handle would move rigidly, since nothing else holds them.
int held_by_nothing(const Region& region);

}  // namespace lapedit
