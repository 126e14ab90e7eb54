// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/edit/edit_step.h"
#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// What is selected in a mesh, vertex numbers, ascending.
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
/// is by position, its vertices become those of this mesh: of each the nearest; of a set, but of one with targets, also
/// those around that are nearer to a listed vertex of the set than to any other that is listed.
/// @param selection  for VertexQuery::selected: a group takes vertices, or else the corners of faces; a region the
/// reverse
/// @throws EditError (BadParameter, NotFinite) if a point is far from the surface or not finite; (NoHandle) if
///         nothing is selected; (BadParameter) if two points with targets are nearest to one vertex; (MeshMismatch) if
///         a position is too far away
/// Cost: O(vertices + faces) where there is a query or position, else none.
Edit located(const TriangleMesh& mesh, const Adjacency& adjacency, Edit edit, const SelectedVertices& selection = {});

/// Returns the edit with the positions of the vertices that its steps name, and of those next to sets of them; without,
/// if there are more than 200,000. The mesh is the one before the first step.
/// @throws EditError (BadIndex)
Edit with_positions(const TriangleMesh& mesh, const Adjacency& adjacency, Edit edit);

}  // namespace lapedit
