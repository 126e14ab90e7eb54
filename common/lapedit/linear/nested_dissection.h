// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// An elimination order with little fill for M^T M plus a diagonal, M with the pattern of a mesh's edges (a Laplacian).
///
/// Nested dissection (George 1973) of the graph of first and second neighbours, which is never made: a piece is cut by
/// a plane or between two levels of a breadth-first search, the separator made the smallest in a band around the cut by
/// a largest flow, and what is left after some levels ordered by minimum degree. Right for any graph and any points;
/// small fill takes a surface.
/// @param neighbours  first neighbours, symmetric, each once
/// @param points      n x 3, finite, any unit: where to cut
/// @param threads     to use (0: all of the machine's); the order does not depend on it
/// @return            order[k] = vertex eliminated k-th
/// Cost: O(n log n), about 2 microseconds per vertex at 100,000; some 200 bytes per vertex.
std::vector<int> nested_dissection(const IndexLists& neighbours, const Points& points, int threads = 1);

/// The order in which a factorisation of an editor's system over a graph should eliminate its vertices; empty where
/// approximate minimum degree does as well, below some ten thousand vertices.
///
/// Nested dissection by coordinates, with numbers of edges to three far-off vertices for coordinates: on a surface they
/// cut as well as its own (2 to 3 % more fill), and a shape that has been edited keeps its order, and so its factor.
/// @param threads  at most this many (0: all of the machine's); the order does not depend on it
/// Cost: as nested_dissection().
std::vector<int> fill_reducing_ordering(const IndexLists& neighbours, int threads);

}  // namespace lapedit
