// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/cells/coarse_system.h"
#include "lapedit/cells/region_cells.h"
#include "lapedit/deform/matrix_averages.h"
#include "lapedit/linear/linear.h"

namespace lapedit {

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

}  // namespace lapedit
