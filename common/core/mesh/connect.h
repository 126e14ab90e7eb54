// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns the neighbours of a mesh with links over gaps. Pieces that are not connected but near each other, such as an
/// eye and its socket, get a link from each vertex to the nearest one of another piece. A border vertex also gets one
/// to the nearest border vertex of the same piece that is more than three times as far along the surface, as at the
/// seam of a tube that was cut open, if it is nearer. A vertex of a wall that is closed, or has small holes, gets one
/// through its inside to the other side, as does that of a plate. A link is at most as long as the gap and counts as an
/// edge without faces. A vertex accepts at most kMostLinks links from others, the shortest of them, so that no vertex
/// of a coarse piece next to a fine one has thousands of neighbours. Deterministic.
/// @param gap      model units, > 0 and finite
/// @param allowed  if given, one flag per vertex: only flagged ones are linked
/// @throws EditError (BadParameter)
/// Cost: O(vertices log vertices), however long the gap is. At most some thousand pairs per vertex are looked at, each
/// of which is a unit of work of checkpoint().
constexpr int kMostLinks = 3;
CompressedRows linked_neighbours(const TriangleMesh& mesh, const CompressedRows& neighbours, double gap,
                                 const std::vector<char>* allowed = nullptr);

/// Returns the neighbours with further edges, given in both directions, ascending.
CompressedRows with_edges(const CompressedRows& neighbours, const std::vector<std::pair<int, int>>& edges);

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
