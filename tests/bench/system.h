// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <vector>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

namespace speed {

using Sparse = Eigen::SparseMatrix<double>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// The region's least-squares system with the umbrella operator, assembled
/// here, so that the peers' matrix and the checks are independent of the
/// library.
struct System {
  int order = 1;
  Sparse first;                     ///< M_1
  Sparse m;                         ///< M^k
  Eigen::VectorXd squared_weights;  ///< 0 for free vertices
  Sparse normal;                    ///< M^T M + W^2, both halves
};

System make_system(const lapedit::Region& region, int order, double handle_weight, double anchor_weight);

/// Right-hand side of a frame: constraints, and the rest pose's differential
/// coordinates turned; for the displacement from the rest pose.
Columns frame_rhs(const System& system, const lapedit::Region& region, const lapedit::Points& rest,
                  const lapedit::Affine& handle, const std::vector<lapedit::Matrix3>& rotations);

/// Solution to (nearly) full double precision: iterative refinement in extended
/// precision with some double solver.
struct Refined {
  Columns x;
  double accuracy = 0;  ///< last correction over the solution's largest entry;
                        ///< above 1e-12 it did not settle
};
using Solver = std::function<void(const Columns& rhs, Columns& x)>;

/// Of system.normal x = rhs, the matrix as rounded.
Refined refine_normal(const System& system, const Columns& rhs, const Solver& solver);
/// Of (M^T M + W^2) x = rhs, the product never rounded to a matrix.
Refined refine_least_squares(const System& system, const Columns& rhs, const Solver& solver);

/// Largest difference over the reference's largest entry.
double relative_error(const Columns& x, const Columns& reference);

}  // namespace speed
