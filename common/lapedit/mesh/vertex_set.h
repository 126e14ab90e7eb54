// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// Sets of mesh vertices are ascending lists without duplicates.

/// The set and all its neighbours. O(size of the result), plus sorting.
std::vector<int> grown(const Adjacency& adjacency, const std::vector<int>& set);

/// The set without the vertices that have a neighbour outside it, except those to keep. A border of the mesh is no
/// outside.
std::vector<int> shrunk(const Adjacency& adjacency, const std::vector<int>& set, const std::vector<int>& keep);

std::vector<int> united(const std::vector<int>& a, const std::vector<int>& b);
std::vector<int> without(const std::vector<int>& a, const std::vector<int>& b);

/// Vertices within a distance along the surface of a vertex (that vertex alone for a radius of 0).
/// @throws EditError (BadIndex, BadParameter if the radius is negative or not finite)
std::vector<int> vertices_within(const TriangleMesh& mesh, const Adjacency& adjacency, int vertex, double radius);

/// Vertices of a shortest path along edges, from the first to the second, both included; empty if no path leads there.
/// Deterministic: of several as short, always the same.
/// @throws EditError (BadIndex)
std::vector<int> shortest_path(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to);

}  // namespace lapedit
