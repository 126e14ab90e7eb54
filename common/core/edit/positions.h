// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/edit/edit_step.h"
#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// The selection of a mesh as ascending vertex numbers.
struct SelectedVertices {
  std::vector<int> vertices;
  std::vector<int> of_faces;  ///< corners of selected faces
};

/// Returns the edit with its landmarks in the coordinate system of the mesh. If the mesh's is unknown, targets are
/// converted to the system of their points. Landmarks of an unknown system stay.
/// @throws EditError (BadParameter) for a system that cannot be converted
Edit in_space(Edit edit, const std::string& mesh_space);

/// Returns the edit with a vertex number for each position, on the mesh before its first step. A group with targets and
/// points moves each vertex as its point: the vertex ends as far from the target as it was from the point. If the edit
/// is by position, each of its vertices is replaced by the nearest vertex of this mesh. A set without targets also gets
/// the vertices that are nearer to one of its members than to any other listed vertex.
/// @param selection  for VertexQuery::selected: a group takes vertices, or else the corners of faces; a region the
/// reverse
/// @throws EditError (BadParameter, NotFinite) if a point is far from the surface or not finite; (NoHandle) if
///         nothing is selected; (BadParameter) if two points with targets are nearest to one vertex; (MeshMismatch) if
///         a position is too far away
/// Cost: O(n log n) where there is a query or position, else none.
Edit located(const TriangleMesh& mesh, const Adjacency& adjacency, Edit edit, const SelectedVertices& selection = {});

/// Returns the edit with the positions of the vertices that its steps name and of the neighbours of vertex sets. If
/// there are more than 200,000, it adds none. The mesh is the one before the first step.
/// @throws EditError (BadIndex)
Edit with_positions(const TriangleMesh& mesh, const Adjacency& adjacency, Edit edit);

}  // namespace lapedit
