// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// The neighbours of all vertices of a mesh; built once per mesh, independent of its coordinates.
struct Adjacency {
  CompressedRows neighbours;  ///< per vertex: the other ends of its edges, ascending, each once
  CompressedRows faces;       ///< per vertex: the faces around it, ascending, each once
  bool oriented = true;       ///< whether no two faces pass an edge in the same direction
};

/// Builds the adjacency. Degenerate faces contribute only edges between different vertices. O(vertices + faces).
Adjacency build_adjacency(int vertex_count, const Faces& faces);

/// Returns the faces around each vertex, as in Adjacency.
CompressedRows faces_around(int vertex_count, const Faces& faces);

/// Labels the connected components of a graph 0, 1, ... in the order of their lowest vertices. Rows have to be
/// ascending, and each edge has to be in the rows of both of its ends.
/// @param labels  out: per vertex
/// @param kinds   per vertex, or empty: edges between vertices of different kinds are ignored
/// @return        the number of components
int connected_components(const CompressedRows& neighbours, std::vector<int>& labels,
                         const std::vector<char>& kinds = {});

/// Returns for each side of a face, number 3 f + s from corner s to the next one, the other side of the same edge; -1
/// unless the edge has exactly two sides. O(faces)
std::vector<int> paired_sides(int vertex_count, const Faces& faces);

/// Returns which faces have to be flipped so that those that share an edge of two faces agree with the first one. Where
/// that is impossible, as on a Moebius strip, some do not. @param partner  paired_sides(). Cost: O(faces)
std::vector<char> flips_of(const std::vector<int>& partner, const Faces& faces);

/// Concatenated paths along edges; a closed one ends with its first vertex.
struct Chains {
  std::vector<unsigned> vertices;
  std::vector<int> lengths;  ///< vertices of each
};

/// Returns the edges that belong to exactly one of some faces, as pairs of ascending vertices, ascending.
/// @param corners  three per face. Cost: O(faces log faces)
std::vector<std::pair<unsigned, unsigned>> single_edges(const std::vector<unsigned>& corners);
/// Returns such edges of all faces as triangles without area, whose last two corners are equal.
Faces border_edges(const Faces& faces);

/// Returns the outline of some faces: the edges that belong to exactly one of them, joined to chains. O(faces log
/// faces)
Chains border_of(const std::vector<unsigned>& corners);

/// Counts and extent of a mesh, for laplacian-edit --info.
struct MeshSummary {
  int vertices = 0, faces = 0;
  int ignored = 0;                    ///< faces that keep_distinct() removes; the following counts are without them
  int loose = 0;                      ///< vertices without a face
  int not_finite = 0;                 ///< vertices with a coordinate that is NaN or infinite
  int pieces = 0, largest_piece = 0;  ///< components connected by faces; number of vertices of the largest
  int borders = 0, border_edges = 0;  ///< connected lines of edges that have one face; number of these edges
  Eigen::AlignedBox3d box;            ///< of all finite vertices; may be empty
};

/// @throws EditError as validate() for corners out of range. O(n log n)
MeshSummary summary_of(const TriangleMesh& mesh);

}  // namespace lapedit
