// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// What belongs to a region although the radius or the surface does not lead to it: RegionSpec::tips and pieces.
struct Attached {
  std::vector<double> distance;            ///< per mesh vertex, of the whole region; kUnreached outside
  std::vector<char> is_free;               ///< per mesh vertex: it is no anchor of the band
  std::vector<std::pair<int, int>> links;  ///< mesh vertices, in both directions, ascending
  int pieces = 0;                          ///< number of pieces that come along
};

/// @param distance  per mesh vertex, from the handles; kUnreached outside the region
/// @param allowed   of a given set one flag per vertex, otherwise empty
/// Cost: O(mesh) for pieces; tips alone take O(region).
Attached attached_to(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                     std::vector<double> distance, const std::vector<char>& allowed);

}  // namespace lapedit
