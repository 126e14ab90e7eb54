// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/geodesic_falloff.h"
#include "lapedit/deform/rest_pose.h"
#include "lapedit/deform/smooth_normals.h"
#include "lapedit/linear/linear.h"

namespace lapedit {

/// Relative accuracy of solutions that later passes refine further.
constexpr double kAccurate = 1e-8;

/// The operators of a system: M of the paper's section 3, and its power M^k, where k is the order. For order 1 without
/// links both are the same object.
struct LaplacianPowers {
  std::shared_ptr<const OperatorRows> m, first;
  Eigen::VectorXd divisor;  ///< D of M = D^-1 L
  Eigen::VectorXd stretch;  ///< the diagonal c D, see membrane_factor() and OperatorRows; empty without a membrane
  Eigen::VectorXd links;    ///< link_strengths(), whose rows m has below those of M^k; empty without links
};

/// The linear system of an edit, independent of the handles' motions (paper, sections 3 and 7). prepare_system() makes
/// it; afterwards it is only read.
///
/// Its matrix is A = (M^k)^T M^k + c L + W^2, with the membrane's stiffness matrix L and the weights of handles and
/// anchors on the diagonal of W. A is symmetric, and positive definite since each component of the region has a
/// constraint.
///
/// Operator and factor depend on the region, its anchors and the settings. Each is shared by pointer with the system of
/// the next handle if it fits. The thread pool is shared as well, so only one of the sharing objects may compute at a
/// time.
struct LaplacianSystem {
  std::shared_ptr<const RestPose> shared_rest;
  const RestPose& rest;
  const Region& region;
  EditSettings settings;
  SolverOptions options;
  std::shared_ptr<ThreadPool> pool;
  LaplacianPowers powers;
  std::shared_ptr<const std::vector<int>> order;  ///< elimination order; null if it was not computed
  Eigen::VectorXd squared_weights;                ///< w_i^2 of handles and anchors, 0 for free vertices
  std::shared_ptr<const FactoredNormalMatrix> matrix;
  std::shared_ptr<const WoodburyCorrection> correction;  ///< for small handles, which are not in the factor; else null
  double operator_ms = 0, factor_ms = 0;                 ///< that making it took
  double normal_radius = 0;                              ///< of the kernel; 0 without
  std::unique_ptr<const SmoothingKernel> kernel;         ///< for EditMethod::Paper, else null
  GeodesicFalloff falloff;                               ///< empty unless rotations are estimated from it
  std::shared_ptr<const Points> fair;                    ///< fair_displacement(); null if it is not known

  LaplacianSystem(std::shared_ptr<const RestPose> pose, const EditSettings& given, const SolverOptions& with)
      : shared_rest(std::move(pose)), rest(*shared_rest), region(*rest.region), settings(given), options(with) {}
  /// Returns whether each component of the region has an anchor.
  bool all_anchored() const;
};

/// @param previous  system whose operator and factor are shared if they fit; null: the same bits in more time
/// @param metric    of LaplacianKind::Surface, see surface_laplacian()
/// @throws EditError (IllConditioned, Cancelled)
std::shared_ptr<const LaplacianSystem> prepare_system(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest,
                                                      const EditSettings& settings, const SolverOptions& options,
                                                      const LaplacianSystem* previous,
                                                      const std::vector<Matrix3>* metric = nullptr);

/// @throws EditError (NotFinite) with a message for the user unless all positions of a result are finite
void require_finite_result(const Points& positions);

/// Always throws EditError (IllConditioned) with a message for the user.
[[noreturn]] void refuse_conditioning(const LaplacianSystem& system);

/// Calls a function that factorises a matrix of an edit. @throws EditError (IllConditioned) with a message for the user
/// if the matrix is singular
void factorise_for(const Region& region, const std::function<void()>& factorise);

/// Returns b - p, the displacement from the rest pose p to the surface b without details, which setting `detail`
/// scales. b minimises
///
///     |M^k x - M^(k-1) h delta|^2 + sum_i w_i^2 |x_i - p_i|^2,
///
/// the bending energy through anchors and handles. h is 0 inside the region, so that a plate becomes flat and a sphere
/// round. Across the anchor band, whose details stay, it rises to 1; it is 1 at borders of the mesh, which would
/// contract otherwise. Stretching has no cost, since a membrane would flatten what is round.
///
/// Solved by conjugate gradients with the system's factor as preconditioner. The bits are the same for any number of
/// threads. Cost: 10 to 60 solves.
/// @return size() x 3. @throws EditError (BadParameter) if a component of the region has no anchor; (Cancelled)
Points fair_displacement(const LaplacianSystem& system);

}  // namespace lapedit
