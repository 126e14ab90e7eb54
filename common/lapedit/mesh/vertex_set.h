// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// @param what   names the vertex in the message, such as "Handle vertex"
/// @param count  vertices of the mesh
/// @throws EditError (BadIndex) if there is no such vertex
void require_vertex(const char* what, int vertex, Eigen::Index count);

// Sets of vertices are ascending lists without duplicates.

/// Any order and duplicates -> a set.
std::vector<int> sorted_set(std::vector<int> vertices);

/// Where a vertex stands in a set, -1 if it is not in it.
int place_in(const std::vector<int>& set, int vertex);
inline bool contains(const std::vector<int>& set, int vertex) {
  return place_in(set, vertex) >= 0;
}

/// The set and all its neighbours. O(size of the result), plus sorting.
std::vector<int> grown(const Adjacency& adjacency, const std::vector<int>& set);

/// The set without the vertices that have a neighbour outside it, except those to keep. A border of the mesh is no
/// outside.
std::vector<int> shrunk(const Adjacency& adjacency, const std::vector<int>& set, const std::vector<int>& keep);

std::vector<int> united(const std::vector<int>& a, const std::vector<int>& b);
std::vector<int> common(const std::vector<int>& a, const std::vector<int>& b);
std::vector<int> without(const std::vector<int>& a, const std::vector<int>& b);

/// Rows of some vertices, and back to where they came from.
Points gather(const Points& points, const std::vector<int>& vertices);
void scatter(const std::vector<int>& vertices, const Points& rows, Points& points);

/// Vertices within a distance along the surface of a vertex (that vertex alone for a radius of 0).
/// @throws EditError (BadIndex, BadParameter if the radius is negative or not finite)
std::vector<int> vertices_within(const TriangleMesh& mesh, const Adjacency& adjacency, int vertex, double radius);

/// Vertices of a shortest path along edges, from the first to the second, both included; empty if no path leads there.
/// Deterministic: of several as short, always the same.
/// @throws EditError (BadIndex)
std::vector<int> shortest_path(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to);

/// Returns the vertex with at least one face that is nearest to a point.
/// @throws EditError (NotFinite, BadParameter) if the point is not finite, or farther from every such vertex than a
///         tenth of the bounding box's diagonal
int nearest_vertex(const TriangleMesh& mesh, const Vector3& point);

}  // namespace lapedit
