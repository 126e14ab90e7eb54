// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/cells/region_cells.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/group_paths.h"

namespace lapedit {

/// The equations of an edit on the cells of a region. They approximate those of LaplacianEditor where fields vary
/// slowly.
///
/// L is the operator's stiffness matrix on the cells' triangles. It is assembled with linear elements, in which
/// gradients cost as much as on the region's own edges. M = D^-1 L, where D has the sums of weights; each row counts
/// once per vertex of its cell. A membrane adds c L, see membrane_factor(). Anchors are constraints of their cells;
/// handles are weighted rows of the blend, one per cell and group, at the mean of the group's vertices in the cell.
/// Order k uses M^k, as for the region.
class CoarseSystem {
 public:
  /// The constraint of one handle group on one cell.
  struct Held {
    int cell, group;
    Vector3 mean;   ///< of the group's vertices in the cell, by their w^2
    double weight;  ///< sum of their w^2
    std::vector<std::pair<int, double>> row;
    std::vector<std::pair<int, double>> vertices;  ///< of the region, with their shares of the mean

    Vector3 displacement(const GroupPaths& paths) const;  ///< of the mean
  };

  /// @throws EditError (IllConditioned)
  CoarseSystem(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
               const EditSettings& settings);

  const std::vector<Held>& held() const { return held_; }

  /// Computes x = (M^kT N M^k + W^2)^-1 right, cells x 3. Nothing is allocated after the first call.
  void solve(const Points& right, Points& x) { normal_->solve(right, x); }
  /// M = D^-1 L.
  const SparseMatrix& differential_operator() const { return first_; }
  /// Adds (M^kT N + c D) M^(k-1) turned to `right`.
  /// @param turned  also used as scratch
  void add_turned(Points& turned, Points& right) const;

 private:
  void hold_handles(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
                    double handle_weight);
  void make_normal(const Region& region, const Points& rest, const RegionCells& cells, const EditSettings& settings);

  SparseMatrix first_, power_;      // M and M^k
  Eigen::VectorXd rows_, stretch_;  // N, c D
  int order_;
  std::vector<Held> held_;
  std::unique_ptr<SparseCholesky> normal_;
  mutable Points between_;
};

}  // namespace lapedit
