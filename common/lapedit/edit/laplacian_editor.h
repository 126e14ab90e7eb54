// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lapedit/cells/cell_model.h"
#include "lapedit/deform/pose_solver.h"

// For example, vertex 42 pulled up with all that is within 0.3 of it:
//
//     RegionSpec spec;
//     spec.radius = 0.3;
//     const Adjacency adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
//     LaplacianEditor editor(mesh, build_region(mesh, adjacency, spec, {{42}}), EditSettings());
//     Affine up = Affine::Identity();
//     up.translation().z() = 0.1;
//     const Points& result = editor.solve({up});
//     for (int i = 0; i < editor.region().size(); ++i) {
//       mesh.vertices.row(editor.region().mesh_vertex[i]) = result.row(i);
//     }

namespace lapedit {

/// One region with its handles, ready for any number of poses: a PoseSolver that starts from the rotations of a
/// CellModel with DetailRotation::LocalGlobal. The same motions give the same bits, independent of earlier poses.
class LaplacianEditor {
 public:
  /// @param mesh      rest pose; not kept
  /// @param previous  as for PoseSolver
  /// @throws EditError (BadParameter, NoHandle, IllConditioned, Cancelled)
  LaplacianEditor(const TriangleMesh& mesh, std::shared_ptr<const Region> region, const EditSettings& settings,
                  const Progress& progress = {}, std::unique_ptr<LaplacianEditor> previous = nullptr);
  LaplacianEditor(const TriangleMesh& mesh, Region region, const EditSettings& settings, const Progress& progress = {},
                  std::unique_ptr<LaplacianEditor> previous = nullptr)
      : LaplacianEditor(mesh, std::make_shared<const Region>(std::move(region)), settings, progress,
                        std::move(previous)) {}
  /// Uses existing cells. @param cells of the same mesh and settings
  LaplacianEditor(const TriangleMesh& mesh, std::shared_ptr<CellModel> cells, const EditSettings& settings,
                  const Progress& progress, std::unique_ptr<LaplacianEditor> previous);

  const Region& region() const { return solver_->system().region; }
  const LaplacianSystem& system() const { return solver_->system(); }
  RefinedSolver& solver() const { return solver_->solver(); }  ///< see PoseSolver::solver()
  const std::string& taken_over() const { return solver_->taken_over(); }
  const std::shared_ptr<CellModel>& cells() const { return cells_; }  ///< null if they are not needed

  /// See PoseSolver::solve(). @throws EditError as PoseSolver::solve(); the editor stays usable
  const Points& solve(const std::vector<HandleMotion>& handles, const Affine& anchors = Affine::Identity(),
                      const Progress& go_on = {});

  const std::vector<Matrix3>& rotations() const { return solver_->rotations(); }
  const Points& positions() const { return solver_->positions(); }  ///< of the last solve(); no rows before the first

  /// See PoseSolver::report().
  EditReport report(const Points& stored, bool whole = true) const;
  EditReport report() const { return report(positions()); }

 private:
  void prepare(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest, const EditSettings& settings,
               const Progress& progress, std::unique_ptr<LaplacianEditor> previous);

  std::shared_ptr<CellModel> cells_;
  std::unique_ptr<PoseSolver> solver_;
  std::vector<Matrix3> start_;
  double cells_ms_ = 0, turn_ms_ = 0;  // of constructing the cells, and of their last pose
};

}  // namespace lapedit
