// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

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
