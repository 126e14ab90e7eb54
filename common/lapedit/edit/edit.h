// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "lapedit/edit/mirror.h"
#include "lapedit/edit/places.h"
#include "lapedit/edit/step_runner.h"

namespace lapedit {

/// The new positions of the moved vertices; all others stay.
struct EditResult {
  std::vector<int> vertices;        ///< ascending mesh vertex numbers
  Points positions;                 ///< one row per entry of vertices
  std::vector<EditReport> reports;  ///< one per step
};

/// @throws EditError (MeshMismatch) if the mesh differs from the edit's description of its mesh
void require_same_mesh(const TriangleMesh& mesh, const Edit& edit);

/// Runs all steps, each on the result of the one before, and passes each result to `each`. The mesh is not changed.
/// Requires a mesh that has passed validate(), and its adjacency.
/// @param fraction  how far the handles go, 0 to 1
/// @throws EditError (BadParameter if fraction is outside [0, 1]; BadScript if there are no steps; and what a step
/// throws, with the step's number before the message when there are several)
void apply_steps(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit, double fraction,
                 StoredScalar scalar, const Progress& progress, const std::function<void(EditResult&&)>& each);

/// Runs one step. @throws EditError as apply_steps()
EditResult apply_step(const TriangleMesh& mesh, const Adjacency& adjacency, const EditStep& step, double fraction = 1,
                      StoredScalar scalar = StoredScalar::Double, const Progress& progress = {});

/// Runs all steps of an edit on the mesh that it was made for; the mesh is not changed.
///
///     const EditResult result = apply_edit(mesh, edit, 1, StoredScalar::Float);
///     for (std::size_t i = 0; i < result.vertices.size(); ++i) {
///       mesh.vertices.row(result.vertices[i]) = result.positions.row(i);
///     }
///
/// @throws EditError as apply_steps(); (MeshMismatch)
EditResult apply_edit(const TriangleMesh& mesh, const Edit& edit, double fraction = 1,
                      StoredScalar scalar = StoredScalar::Double, const Progress& progress = {});

/// Runs the edit for several fractions, each with the same bits as alone. Requires a mesh that has passed validate(),
/// and its adjacency. The first step is prepared once for all fractions; later steps start from different shapes and
/// reuse what still fits. @return one result per fraction, in their order. Preparation times of 0 in a report mean that
/// the preparation was reused @throws EditError as apply_edit(), with the fraction before the message when there are
/// several
std::vector<EditResult> apply_edit(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                                   const std::vector<double>& fractions, StoredScalar scalar = StoredScalar::Double,
                                   const Progress& progress = {});

/// The same for a mesh that has not been checked, with what is selected in it. @throws EditError also as validate() and
/// located()
std::vector<EditResult> apply_edit(const TriangleMesh& mesh, const Edit& edit, const SelectedVertices& selection,
                                   const std::vector<double>& fractions, StoredScalar scalar,
                                   const Progress& progress = {});

/// Returns the reports of an edit's steps as text for a log, without a trailing newline.
std::string text_of(const std::vector<EditReport>& reports);

}  // namespace lapedit
