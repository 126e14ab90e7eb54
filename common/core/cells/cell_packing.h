// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns the handle groups that have cells of their own, ascending: all, or the largest ones if there are more than
/// 400 groups, since each group would need a cell. Vertices of the others are like free vertices for the cells.
/// O(vertices)
std::vector<int> groups_with_cells(const Region& region);

/// Divides a region into patches of neighbouring vertices that are about as wide as long, whatever the shape of the
/// triangles.
///
/// Seeds are packed along the surface: from the boundaries of the handles outwards and inwards, each vertex that is
/// farther than the local spacing from all earlier seeds becomes a seed. A cell consists of the vertices that are
/// nearest to its seed along edges. The spacing grows with the distance from the handles, and towards the inside of
/// rigid groups and of the anchor band, where rotations do not vary. Vertices at the same distance from the handles are
/// sorted by their distance from the region's middle, then by the edges around them and the nearest group, then by
/// coordinates, and by number only if coordinates are equal. Two vertices that are each other's mirror images and near
/// each other begin one cell. Neighbouring groups of groups_with_cells() have cells of their own. The result is the
/// same for any number of threads.
/// @param rest    size() x 3, the region's rest pose about a local origin
/// @param target  wanted number of cells; the part that is not rigid has at most one cell per five vertices
/// @param of      out: the cell of each vertex of the region
/// @return        the number of cells, close to `target`
/// Cost: O(edges).
int pack_cells(const Region& region, const Points& rest, int target, ThreadPool& pool, std::vector<int>& of);

}  // namespace lapedit
