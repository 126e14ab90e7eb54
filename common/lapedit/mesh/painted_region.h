// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns a painted region before its distances are known, with its rim as anchors. O(region), and one
/// number per mesh vertex.
Region painted_region(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                      const std::vector<std::vector<int>>& groups);

/// Returns the number of vertices in components without anchors and with one handle group, which would move rigidly.
int held_by_nothing(const Region& region);

}  // namespace lapedit
