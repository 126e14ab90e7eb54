// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/deform/edit_report.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/geodesic_falloff.h"
#include "lapedit/deform/rest_pose.h"
#include "lapedit/deform/smoother.h"
#include "lapedit/linear/refined_solver.h"

namespace lapedit {

/// Relative accuracy of solutions that later passes refine further.
constexpr double kAccurate = 1e-8;

/// The operators M^k and M_1 = M of the paper's section 3, k the order; for order 1 both are the same object.
struct LaplacianPowers {
  std::shared_ptr<const OperatorRows> m, first;
  int uniform_edges = 0;    ///< see DifferentialOperator
  Eigen::VectorXd stretch;  ///< c D of membrane_factor(), which m adds to M^T; empty without a membrane
};

/// The linear system of an edit, independent of the handles' motions. prepare_system() makes it; afterwards it is only
/// read.
///
/// Operator, factor and smoother depend on the region, its anchors and the settings. Each is shared by pointer with the
/// system of the next handle if it fits. Users work on copies with their own scratch memory: a RefinedSolver, and the
/// result of Smoother::share(). The thread pool is shared as well, so only one of the sharing objects may compute at a
/// time.
struct LaplacianSystem {
  std::shared_ptr<const RestPose> shared_rest;
  const RestPose& rest;
  const Region& region;
  EditSettings settings;
  std::shared_ptr<ThreadPool> pool;
  LaplacianPowers powers;
  std::shared_ptr<const std::vector<int>> order;  ///< elimination order; null if it was not computed
  Points delta;                                   ///< M_1 p of the rest pose, for DetailTurning::Vertex only
  Eigen::VectorXd squared_weights;                ///< w_i^2 of handles and anchors, 0 for free vertices
  std::shared_ptr<const FactoredNormalMatrix> matrix;
  std::shared_ptr<const WoodburyCorrection> correction;  ///< for small handles, which are not in the factor; else null
  int refinements = 0;                                   ///< steps to kAccurate without the correction
  double normal_radius = 0;                              ///< 0 without rotation
  std::shared_ptr<const Smoother> smoother;              ///< for smooth normals and surfaces, else null
  GeodesicFalloff falloff;                               ///< empty unless rotations are estimated from it

  LaplacianSystem(std::shared_ptr<const RestPose> pose, const EditSettings& given)
      : shared_rest(std::move(pose)), rest(*shared_rest), region(*rest.region), settings(given) {}
  bool all_anchored() const;
};

/// @param previous  system whose operator, factor and smoother are shared if they fit; null: the same bits in more time
/// @param report    out: times, counts and the shared parts
/// @throws EditError (IllConditioned, Cancelled)
std::shared_ptr<const LaplacianSystem> prepare_system(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest,
                                                      const EditSettings& settings, const LaplacianSystem* previous,
                                                      const Progress& progress, EditReport& report);

/// Always throws EditError (IllConditioned) with a message for the user.
[[noreturn]] void refuse_conditioning(const LaplacianSystem& system);

}  // namespace lapedit
