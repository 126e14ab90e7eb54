// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// @param what   names the vertex in the message, such as "Handle vertex"
/// @param count  vertices of the mesh
/// @param key    of the error
/// @throws EditError (BadIndex) if there is no such vertex
void require_vertex(const char* what, int vertex, Eigen::Index count, const char* key = "vertices");

// Sets of vertices are ascending lists without duplicates.

/// Returns the set of the vertices, or of other values, given in any order, with duplicates.
template <class Value = int>
std::vector<Value> sorted_set(std::vector<Value> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

/// Returns the index of a vertex in a set, -1 if it is not in it.
int index_in(const std::vector<int>& set, int vertex);
inline bool contains(const std::vector<int>& set, int vertex) {
  return index_in(set, vertex) >= 0;
}

/// Returns the set and all its neighbours. O(size of the result), plus sorting.
std::vector<int> grown(const Adjacency& adjacency, const std::vector<int>& set);

/// Returns the set without the vertices that have a neighbour outside it, except those to keep. The border of the mesh
/// does not count as outside.
std::vector<int> shrunk(const Adjacency& adjacency, const std::vector<int>& set, const std::vector<int>& keep);

/// Return the union, the intersection, and the difference of two sets.
std::vector<int> united(const std::vector<int>& a, const std::vector<int>& b);
std::vector<int> common(const std::vector<int>& a, const std::vector<int>& b);
std::vector<int> without(const std::vector<int>& a, const std::vector<int>& b);

inline Vector3 position_of(const Points& points, int vertex) {
  return points.row(vertex).transpose();
}

/// Return the rows of some vertices or faces.
Points gather(const Points& points, const std::vector<int>& vertices);
Faces gather(const Faces& faces, const std::vector<int>& numbers);
/// Writes such rows to the positions of their vertices.
void scatter(const std::vector<int>& vertices, const Points& rows, Points& points);

/// Returns the vertices within a distance of a vertex along the surface (that vertex alone for a radius of 0).
/// @throws EditError (BadIndex, BadParameter if the radius is negative or not finite)
std::vector<int> vertices_within(const TriangleMesh& mesh, const Adjacency& adjacency, int vertex, double radius);

/// Returns the vertices of a shortest path along edges, both ends included; empty if there is no path. Deterministic:
/// always the same one of several shortest paths.
std::vector<int> shortest_path(const TriangleMesh& mesh, const Adjacency& adjacency, int from, int to);

}  // namespace lapedit
