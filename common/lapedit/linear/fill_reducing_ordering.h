// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// The order in which a factorisation of an editor's system over a graph should eliminate its vertices; empty where
/// approximate minimum degree does as well, below some ten thousand vertices.
///
/// Nested dissection by coordinates, with numbers of edges to three far-off vertices for coordinates: on a surface they
/// cut as well as its own (2 to 3 % more fill), and a shape that has been edited keeps its order, and so its factor.
/// @param threads  at most this many (0: all of the machine's); the order does not depend on it
/// Cost: as nested_dissection().
std::vector<int> fill_reducing_ordering(const IndexLists& neighbours, int threads);

}  // namespace lapedit
