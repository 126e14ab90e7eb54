// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/edit/edit_step.h"
#include "lapedit/edit/fit_step.h"
#include "lapedit/edit/step_solver.h"
#include "lapedit/mesh/weld.h"

namespace lapedit {

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

}  // namespace lapedit
