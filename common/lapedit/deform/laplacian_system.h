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

/// Enough for what is to be refined further.
constexpr double kAccurate = 1e-8;

/// M^k and M_1 = M of the paper's section 3, k the order; for order 1 one and the same object.
struct LaplacianPowers {
  std::shared_ptr<const OperatorRows> m, first;
  int uniform_edges = 0;    ///< see DifferentialOperator
  Eigen::VectorXd stretch;  ///< c D of membrane_factor(), which m has added to M^T; empty: none
};

/// What an edit is solved with, whatever way its handles go: made once by prepare_system(), then only read.
///
/// Operator, factor and smoother follow from the region, its anchors and the settings: each is shared by pointer with
/// the system of the next handle, for itself, where it fits. None of them is worked with directly: a RefinedSolver has
/// scratch of its own, and so has what Smoother::share() gives. The pool is shared as well, which allows one call at a
/// time among all that share it.
struct LaplacianSystem {
  std::shared_ptr<const RestPose> shared_rest;
  const RestPose& rest;
  const Region& region;
  EditSettings settings;
  std::shared_ptr<ThreadPool> pool;
  LaplacianPowers powers;
  std::shared_ptr<const std::vector<int>> order;  ///< of elimination; nothing where it was not asked for
  Points delta;                                   ///< differential coordinates M_1 p of the rest pose
  Eigen::VectorXd squared_weights;                ///< w_i^2 of handles and anchors, 0 for free vertices
  std::shared_ptr<const FactoredNormalMatrix> matrix;
  std::shared_ptr<const WoodburyCorrection> correction;  ///< small handles, which the factor does not know
  int refinements = 0;                                   ///< steps to kAccurate, where there is no correction
  double normal_radius = 0;                              ///< 0 without rotation
  std::shared_ptr<const Smoother> smoother;              ///< only for smooth normals and surfaces
  GeodesicFalloff falloff;                               ///< empty where rotations are not estimated from it

  LaplacianSystem(std::shared_ptr<const RestPose> pose, const EditSettings& given)
      : shared_rest(std::move(pose)), rest(*shared_rest), region(*rest.region), settings(given) {}
  bool all_anchored() const;
};

/// @param previous  whose operator, factor and smoother are shared where they fit; may be nothing, which gives the same
///                  bits in more time
/// @param report    takes times, counts and what was shared
/// @throws EditError (IllConditioned, Cancelled)
std::shared_ptr<const LaplacianSystem> prepare_system(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest,
                                                      const EditSettings& settings, const LaplacianSystem* previous,
                                                      const Progress& progress, EditReport& report);

/// @throws EditError (IllConditioned), in any case
[[noreturn]] void refuse_conditioning(const LaplacianSystem& system);

}  // namespace lapedit
