// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Divides a region into patches of neighbouring vertices that are about as wide as they are long, whatever its
/// triangles are like.
///
/// Seeds are packed along the surface: from where handles end outwards and inwards, each vertex that is farther than a
/// spacing from all seeds so far becomes the next one. A cell is what is nearest to its seed along edges. The spacing
/// grows with the distance from the handles, and into groups that move rigidly and anchors that stay, where rotations
/// do not vary. Vertices that are equally far from the handles come in the order of their distance from the region's
/// middle, then of their coordinates, and only those with the same coordinates in the order of their numbers. The same
/// for any number of threads.
/// @param rest    size() x 3, the region's rest pose about a local origin
/// @param target  cells wanted; in what is free there are at most one for each five vertices
/// @param of      out: cell of each vertex of the region
/// @return        the number of cells: a few more or less than wanted
/// Cost: O(edges).
int pack_cells(const Region& region, const Points& rest, int target, ThreadPool& pool, std::vector<int>& of);

}  // namespace lapedit
