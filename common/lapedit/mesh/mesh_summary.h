// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// What a mesh is, in numbers.
struct MeshSummary {
  int vertices = 0, faces = 0;
  int loose = 0;                      ///< vertices without a face
  int not_finite = 0;                 ///< vertices with a coordinate that is NaN or infinite
  int pieces = 0, largest_piece = 0;  ///< connected by faces; vertices of the largest
  int borders = 0, border_edges = 0;  ///< connected lines of edges with one face
  Eigen::AlignedBox3d box;            ///< of all finite vertices; may be empty
};

/// @throws EditError as validate() for corners out of range. O(n log n)
MeshSummary summary_of(const TriangleMesh& mesh);

}  // namespace lapedit
