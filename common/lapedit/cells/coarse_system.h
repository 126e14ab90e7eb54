// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "lapedit/cells/region_cells.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/group_paths.h"

namespace lapedit {

/// The equations of an edit on a region's cells: those of LaplacianEditor where fields vary slowly.
///
/// L is the operator's stiffness matrix on the cells' triangles, by linear elements, in which gradients cost as much as
/// they do on the region's own edges; M = D^-1 L with D the sums of weights, and each row counts as often as its cell
/// has vertices. A membrane adds c L, see membrane_factor(). Anchors hold their cells; handles are weighted rows of the
/// blend, one per cell and group, at the mean of the handle's vertices there. Order k takes M^k, as for the region.
class CoarseSystem {
 public:
  /// What a group's handle does to one cell.
  struct Held {
    int cell, group;
    Vector3 mean;   ///< of the group's vertices in the cell, by their w^2
    double weight;  ///< sum of their w^2
    std::vector<std::pair<int, double>> row;
    std::vector<std::pair<int, double>> vertices;  ///< of the region, and each one's share of the mean

    Vector3 displacement(const GroupPaths& paths) const;  ///< of the mean
  };

  /// @throws EditError (IllConditioned)
  CoarseSystem(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
               const EditSettings& settings);

  const std::vector<Held>& held() const { return held_; }

  /// x = (M^kT N M^k + W^2)^-1 right, cells x 3; nothing is allocated after the first call.
  void solve(const Points& right, Points& x) { normal_->solve(right, x); }
  /// M = D^-1 L.
  const SparseMatrix& differential_operator() const { return first_; }
  /// right += (M^kT N + c D) M^(k-1) turned. @param turned  taken as scratch
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
