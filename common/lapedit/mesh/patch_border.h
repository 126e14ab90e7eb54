// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

namespace lapedit {

/// Concatenated paths along edges; a closed one ends with its first vertex.
struct Chains {
  std::vector<unsigned> vertices;
  std::vector<int> lengths;  ///< vertices of each
};

/// Returns the edges that belong to exactly one of some faces, as pairs of ascending vertices, ascending.
/// @param corners  three per face. Cost: O(faces log faces)
std::vector<std::pair<unsigned, unsigned>> single_edges(const std::vector<unsigned>& corners);

/// Returns the outline of some faces: the edges that belong to exactly one of them, joined to chains. O(faces log
/// faces)
Chains border_of(const std::vector<unsigned>& corners);

}  // namespace lapedit
