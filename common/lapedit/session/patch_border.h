// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace lapedit {

/// Ways along edges, behind each other; one that is closed ends with the vertex that it begins with.
struct Chains {
  std::vector<unsigned> vertices;
  std::vector<int> lengths;  ///< vertices of each
};

/// The edges that belong to exactly one of some faces, as chains: an outline of the faces. O(faces log faces).
/// @param corners  three per face
Chains border_of(const std::vector<unsigned>& corners);

}  // namespace lapedit
