// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "lapedit/cells/region_cells.h"
#include "lapedit/cells/small_cholesky.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/group_paths.h"

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

}  // namespace lapedit
