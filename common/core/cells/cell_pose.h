// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lapedit/cells/region_cells.h"
#include "lapedit/cells/small_cholesky.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/group_paths.h"
#include "lapedit/deform/matrix_averages.h"
#include "lapedit/linear/linear.h"

namespace lapedit {

/// The equations of an edit on the cells of a region. They approximate those of LaplacianSystem where fields vary
/// slowly.
///
/// L is the stiffness matrix of linear elements on the cells' triangles, symmetric positive semidefinite, and M = D^-1
/// L with D from the cells' areas, as for LaplacianKind::Surface. A membrane adds c L, see membrane_factor(). Anchors
/// are constraints of their cells; handles are weighted rows of the blend, one per cell and group, at the mean of the
/// group's vertices in the cell. The order is 1 even if the settings ask for a higher one.
class CoarseSystem {
 public:
  /// The constraint of one handle group on one cell.
  struct Held {
    int cell, group;
    Vector3 mean;                                  ///< of the group's vertices in the cell, by their w^2
    double weight;                                 ///< sum of their w^2
    std::vector<std::pair<int, double>> row;       ///< cells whose blend gives the mean, with their weights
    std::vector<std::pair<int, double>> vertices;  ///< of the region, with their weights in the mean

    Vector3 displacement(const GroupPaths& paths) const;  ///< of the mean
  };

  /// @throws EditError (IllConditioned)
  CoarseSystem(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
               const EditSettings& settings);

  const std::vector<Held>& held() const { return held_; }

  /// Returns the groups with cells of their own. The others are too small to rotate the cells around them.
  const std::vector<int>& groups() const { return groups_; }
  /// Returns how much each cell follows each of groups(), cells x groups: 1 on the group, 0 on others and anchors, and
  /// harmonic along the surface between them.
  const Eigen::MatrixXd& follow() const { return follow_; }
  /// Returns for each cell the number of its loose part, or -1. No forces pass through such a part, so it rotates as
  /// one with the cells around it. @param targets  whether vertices of a group move apart
  const std::vector<int>& loose(bool targets) const { return targets ? loose_of_targets_ : loose_; }

  /// Solves (M^T M + c L + W^2) x = right, cells x 3; c L = c D M. The matrix is symmetric positive definite. Only the
  /// first call allocates memory.
  void solve(const Points& right, Points& x) { normal_->solve(right, x); }
  /// M = D^-1 L.
  const SparseMatrix& differential_operator() const { return operator_; }
  /// Adds (M^T + c D) rotated to `right`.
  void add_rotated(const Points& rotated, Points& right) const;

 private:
  void hold_handles(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
                    double handle_weight);
  void make_normal(const Region& region, const Points& rest, const RegionCells& cells, const EditSettings& settings);
  Eigen::MatrixXd make_follow(const RegionCells& cells, const Eigen::VectorXd& anchored,
                              const Eigen::VectorXd& squared_weights);
  static std::vector<int> find_loose(const RegionCells& cells, const Eigen::MatrixXd& follow, double size,
                                     const Eigen::VectorXd& squared_weights);

  SparseMatrix operator_;              // M
  Eigen::VectorXd divisor_, stretch_;  // D, c D
  std::vector<Held> held_;
  std::vector<int> groups_;
  Eigen::MatrixXd follow_;
  std::vector<int> loose_, loose_of_targets_;
  std::unique_ptr<SmallCholesky> normal_;
};

/// Finds rotations of a region's cells by alternating a local step, which fits rotations to the positions of the cells,
/// and a global step, which solves for positions with these rotations. This is as-rigid-as-possible deformation (O.
/// Sorkine, M. Alexa, SGP 2007) on few cells, which makes it cheap, and with bending energy, which keeps it smooth.
///
/// Local step: covariances of smoothed positions before and after, plus |C| n1 n0^T / 2 for the normals, are averaged
/// over some rings, so that smaller details do not tilt the rotations. Global step: CoarseSystem's equations, with each
/// edge between cells rotated by the mean of its ends' rotations.
class LocalGlobal {
 public:
  /// All arguments must outlive the object.
  /// @param hold     per cell: 0 keeps its fitted rotation, 1 replaces it by the identity
  /// @param inertia  per cell, the weight of its last rotation against that of the covariance
  LocalGlobal(const RegionCells& cells, const CellSurface& surface, const std::vector<double>& hold,
              const std::vector<double>& inertia, CoarseSystem& system);

  struct Outcome {
    int passes = 0;
    double left = 0;  ///< change of the last pass, model units
  };

  /// Sets the rigidly moved positions of the cells and the linear part (minus identity) of each motion.
  /// @param targets  as for CoarseSystem::loose()
  void start(const Points& rigid, const std::vector<Matrix3>& linear, bool targets);

  /// Alternates global and local steps, beginning with a global one.
  /// @param constraints   the right-hand side of CoarseSystem::solve() without rotations
  /// @param accurate      change of positions, model units, below which the passes end
  /// @param most_passes   largest number of global steps
  /// @param displacement  out: the solution
  /// @param rotations     in: those of the first global step; out: the last ones
  /// Only the first call allocates memory.
  Outcome settle(const Points& constraints, double accurate, int most_passes, Points& displacement,
                 std::vector<Matrix3>& rotations);

 private:
  struct Covariances;
  struct Rotated;
  /// Data that rotate() reads.
  struct Rotating {
    OperatorRows::Rows m;         // the system's M
    Points edges, sums;           // -M_ab (C_a - C_b) per entry of m, moved rigidly; its sums over rows
    std::vector<double> columns;  // of R - I per cell, four numbers each
  };
  struct Loose {
    std::vector<Matrix3> rotations;        // of the loose parts
    const std::vector<int>* of = nullptr;  // CoarseSystem::loose()
  };
  void fit(const Points& displacement, std::vector<Matrix3>& rotations);
  void hang(std::vector<Matrix3>& rotations);
  void rotate(const std::vector<Matrix3>& rotations, Points& rotated);

  const RegionCells& cells_;
  const CellSurface& surface_;
  const std::vector<double>&hold_, &inertia_;
  CoarseSystem& system_;
  ThreadPool alone_{1};  // for some hundred cells a second thread saves no time
  Points result_, rigid_, smooth_before_, smooth_after_, normals_before_, scratch_, next_, rotated_;
  MatrixAverages averages_;
  std::vector<Matrix3> linear_, covariances_;
  Loose loose_;
  std::vector<Vector3> before_;  // per entry of neighbours: g_ab (P0_b - P0_a)
  Rotating rotating_;
};

/// The pose of the cells of a region: displacements and rotations at the end of the handles' paths. The paths are
/// followed in steps, so that a limb bends to the side from which the handle came. With EditMethod::Linear nothing
/// rotates. Results have the same bits everywhere.
class CellPose {
 public:
  /// The usual number of cells. 1500 cells gave no better rotations.
  static constexpr int kCells = 400;
  /// Returns the number of cells for a region of so many vertices.
  static int wanted_cells(int vertices);

  /// @param region,cells,settings  must outlive the object; blend and rest need not
  CellPose(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
           const EditSettings& settings);
  CellPose(const CellPose&) = delete;
  CellPose& operator=(const CellPose&) = delete;

  /// Follows the paths step by step, with a few passes per step and more in the last one.
  /// @param paths   at their ends before and after the call
  /// @param quick   takes a quarter of the time, with a larger error
  /// The result does not depend on earlier calls. Nothing is allocated after the first call.
  void solve(GroupPaths& paths, bool quick);

  const Points& displacement() const { return displacement_; }          ///< of the centres, from the rigidly moved pose
  const std::vector<Matrix3>& rotations() const { return rotations_; }  ///< likewise
  int passes() const { return passes_; }                                ///< of the last solve()
  double left() const { return left_; }  ///< change in the last pass, over the handles' largest displacement

 private:
  void move_rigidly(const GroupPaths& paths);
  double constrain(const GroupPaths& paths);
  void follow(const GroupPaths& paths);
  void resist_twist();
  int last_passes(bool quick) const;

  const RegionCells& cells_;
  CellSurface surface_;
  CoarseSystem system_;
  bool rotates_;
  std::vector<int> component_;  // of each cell
  std::vector<double> hold_;    // by how much its rotation is reduced, 0 to 1
  std::vector<double> inertia_;
  LocalGlobal local_global_;
  std::vector<Matrix3> linear_;
  Points rigid_, constraints_, displacement_;
  std::vector<Matrix3> rotations_, group_rotations_, rigid_rotations_;  // the last two of the last step
  Points turns_, turned_;  // see eighth(): what the groups rotate the cells by in this step and so far
  int passes_ = 0;
  double left_ = 0;
};

}  // namespace lapedit
