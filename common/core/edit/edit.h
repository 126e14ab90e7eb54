// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/edit/edit_step.h"
#include "lapedit/edit/fit_step.h"
#include "lapedit/edit/mirror.h"
#include "lapedit/edit/positions.h"
#include "lapedit/edit/step_solver.h"
#include "lapedit/mesh/weld.h"

namespace lapedit {

/// The new positions of the moved vertices; all others stay.
struct EditResult {
  std::vector<int> vertices;        ///< ascending mesh vertex numbers
  Points positions;                 ///< one row per entry of vertices
  std::vector<EditReport> reports;  ///< one per step
};

/// One step of an edit, prepared for any number of poses of one shape. A fit is made once, with the preparation.
class PreparedStep {
 public:
  /// @param mesh    the shape before the step; has to outlive the object. With joined, its faces are those of joined
  /// @param joined  the surface of the mesh; null: its own faces, each vertex on its own
  /// @param step    with vertex numbers, see located()
  /// @throws EditError as mirrored(), welded() and sort_group()
  PreparedStep(const TriangleMesh& mesh, std::shared_ptr<const Joined> joined, const EditStep& step,
               StepOptions options);

  /// Finds the region and makes cells and system. Checks the motions of this fraction first, so that errors are
  /// reported at once. @param previous  as for StepSolver::make_system()
  /// @throws EditError as find_region(), motions_of() and StepSolver, or fit_step()
  void prepare(const Adjacency& adjacency, double fraction, const LaplacianSystem* previous = nullptr);

  /// Returns the step with all groups, mirror images included, on representatives.
  const EditStep& step() const { return step_; }
  /// Requires prepare(), and a step without a fit.
  const Region& region() const { return solver_->region(); }
  /// Null before prepare(), and for a fit.
  std::shared_ptr<const LaplacianSystem> system() const { return solver_ ? solver_->system() : nullptr; }

  /// Replaces the motions of the groups. @param step  as for the constructor; only its handles count
  /// @throws EditError as the constructor; (BadParameter) if a group has other vertices than before, or other
  ///         weights where it has any. The motions are then as before
  void move(const EditStep& step);
  /// Computes a pose. Requires prepare().
  /// @param vertices   out: the region's vertices, and all others at their places
  /// @param positions  out: one row per vertex
  /// @throws EditError as motions_of() and StepSolver::pose()
  void pose(double fraction, std::vector<int>& vertices, Points& positions);
  /// Returns the report of the last pose. @param vertices  the whole mesh in that pose
  EditReport report(double fraction, const Points& vertices) const;

 private:
  EditStep whole(const EditStep& given) const;

  const TriangleMesh& mesh_;
  std::shared_ptr<const Joined> joined_;
  StepOptions options_;
  EditStep step_;
  std::unique_ptr<StepSolver> solver_;  // null for a fit
  FittedStep fitted_;
  int welded_ = 0;  // vertices of the last pose that are not the first at their places
};

/// @throws EditError (MeshMismatch) if the mesh differs from the edit's description of its mesh
void require_same_mesh(const TriangleMesh& mesh, const Edit& edit);

/// Receives the results of an edit, one per fraction, in their order.
using EachPose = std::function<void(EditResult&& pose)>;

/// Runs an edit for several fractions of the handles' paths, one after the other. Each result has the same bits as if
/// it were computed alone. The mesh has to have passed validate(); it is not changed. The first step is prepared once
/// for all fractions; later steps start from different shapes and reuse what still fits.
/// @param adjacency  of the mesh; @param selection for VertexQuery::selected
/// @param fractions  0 (no change) to 1
/// @param each       called with each result before the next is computed. Preparation times of 0 in a report mean that
///                   the earlier preparation was used
/// @throws EditError (MeshMismatch) if the mesh differs from the edit's description of its mesh; (BadParameter) if a
///         fraction is outside [0, 1]; (BadScript) if there are no steps; as located(); and what a step throws, with
///         the numbers of step and fraction before the message when there are several
void apply_edit(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                const SelectedVertices& selection, const std::vector<double>& fractions, const EachPose& each,
                StoredScalar scalar = StoredScalar::Double, const Progress& progress = {},
                const SolverOptions& options = {});

/// Returns all these results.
std::vector<EditResult> apply_edit(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                                   const SelectedVertices& selection, const std::vector<double>& fractions,
                                   StoredScalar scalar = StoredScalar::Double, const Progress& progress = {},
                                   const SolverOptions& options = {});

/// The same for one fraction, on a mesh that has not been checked. @throws EditError also as validate()
///
///     const EditResult result = apply_edit(mesh, edit, 1, StoredScalar::Float);
///     for (std::size_t i = 0; i < result.vertices.size(); ++i) {
///       mesh.vertices.row(result.vertices[i]) = result.positions.row(i);
///     }
EditResult apply_edit(const TriangleMesh& mesh, const Edit& edit, double fraction = 1,
                      StoredScalar scalar = StoredScalar::Double, const Progress& progress = {},
                      const SolverOptions& options = {});

/// Returns the result of each step of the whole edit. @throws EditError as apply_edit()
std::vector<EditResult> apply_steps(const TriangleMesh& mesh, const Adjacency& adjacency, const Edit& edit,
                                    StoredScalar scalar = StoredScalar::Double, const Progress& progress = {});

/// Returns the reports of an edit's steps as text for a log, without a trailing newline.
std::string text_of(const std::vector<EditReport>& reports);

}  // namespace lapedit
