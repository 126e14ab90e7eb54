// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/cells/cell_surface.h"
#include "lapedit/cells/coarse_system.h"
#include "lapedit/deform/matrix_averages.h"
#include "lapedit/linear/operator_rows.h"

namespace lapedit {

/// Rotations of a region's cells: fitted to where the cells are (local step), solved with (global step), and again, so
/// many times. As in as-rigid-as-possible deformation (O. Sorkine, M. Alexa, SGP 2007), but
/// on few cells, which makes it cheap, and with bending, which keeps it smooth.
///
/// Local: the covariances of smoothed places before and after with |C| n1 n0^T / 2 for the normals, averaged over some
/// rings; details that are smaller than that do not tilt the rotations. Global: CoarseSystem's equations with each edge
/// between cells turned by the mean of its ends' rotations.
class LocalGlobal {
 public:
  /// All must outlive the object. @param hold  per cell, how far its rotation is held back, 0 to 1
  LocalGlobal(const RegionCells& cells, const CellSurface& surface, const std::vector<double>& hold,
              const EditSettings& settings, CoarseSystem& system);

  struct Outcome {
    int passes = 0;
    double left = 0;  ///< change of the last pass, model units
  };

  /// Where the cells are carried, and by what linear map (minus identity) each.
  void start(const Points& carried, const std::vector<Matrix3>& linear);

  /// @param constraints   what CoarseSystem::solve() is asked for without rotations
  /// @param displacement  out: a result of the equations. @param rotations  in and out: with what the first step, a
  ///                      global one, is made
  /// Nothing is allocated after the first call.
  Outcome settle(const Points& constraints, double accurate, int most_passes, Points& displacement,
                 std::vector<Matrix3>& rotations);

 private:
  struct Edges;
  /// What turn() reads.
  struct Turning {
    OperatorRows::Rows m;       // the system's M
    Points edges, sums;         // per entry of it -M_ab (C_a - C_b), carried along, and over each row
    std::vector<double> turns;  // of each cell the columns of R - I, four numbers each
  };
  void fit(const Points& displacement, std::vector<Matrix3>& rotations);
  void turn(const std::vector<Matrix3>& rotations, Points& turned);

  const RegionCells& cells_;
  const CellSurface& surface_;
  const std::vector<double>& hold_;
  const EditSettings& settings_;
  CoarseSystem& system_;
  ThreadPool alone_{1};  // some hundred cells are not worth a second thread
  Points result_, carried_, smooth_before_, smooth_after_, normals_before_, scratch_, next_, turned_;
  MatrixAverages averages_;
  std::vector<Matrix3> linear_, covariances_;
  std::vector<Vector3> before_;  // per entry of neighbours: g_ab (P0_b - P0_a)
  Turning turning_;
};

}  // namespace lapedit
