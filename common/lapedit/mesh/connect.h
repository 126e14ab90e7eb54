// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// Returns the neighbours of a mesh, with links between pieces that are not connected but near each other, such as an
/// eye and its socket: each vertex of a piece and the nearest vertex of another one, if that is within the gap. A link
/// counts as an edge, without faces. A vertex takes at most kMostLinks from others, the shortest of them, so that no
/// vertex of a coarse piece next to a fine one has thousands of neighbours. Deterministic; vertices in the same place,
/// of length 0, are linked too.
/// @param gap      model units, > 0 and finite
/// @param allowed  if given, one flag per vertex: only flagged ones are linked
/// @throws EditError (BadParameter)
/// Cost: O(vertices), if the gap is not much longer than what lies between the pieces.
constexpr int kMostLinks = 3;
IndexLists linked_neighbours(const TriangleMesh& mesh, const IndexLists& neighbours, double gap,
                             const std::vector<char>* allowed = nullptr);

}  // namespace lapedit
