// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <set>
#include <utility>
#include <vector>

#include "lapedit/edit/step_solver.h"
#include "support.h"

/// The method a second time, slow and plain: dense matrices, absolute positions, a QR factorisation of the stacked
/// system, rotations from their definitions. For small meshes without degenerate faces. Of the region it believes who
/// is in it, the classes and the anchor weights.
namespace lapedit::reference {

using Matrix = Eigen::MatrixXd;

/// Mesh edges with both ends in the region, both ways, local numbers.
std::set<std::pair<int, int>> edges_of(const TriangleMesh& mesh, const Region& region);

/// w_ij, in any unit; tan(angle / 2) over the edge's length on both sides and at both ends for mean values.
Matrix weights_of(const TriangleMesh& mesh, const Region& region, LaplacianKind kind);

Matrix operator_of(const Matrix& weights);

/// What an edge's weight is multiplied by in the membrane's energy sum_ij c w_ij |x_i - x_j - R_ij (p_i - p_j)|^2 / 2.
double membrane_of(const EditSettings& settings, const std::set<std::pair<int, int>>& edges, const Points& rest,
                   const Matrix& weights);

/// Positions that fit the rotated differential coordinates and the constraints best.
/// @param settings  with a membrane: of order 1
/// @param targets  one row per region vertex; those of free vertices do not matter
Points solve(const TriangleMesh& mesh, const Region& region, const EditSettings& settings, const Points& targets,
             const std::vector<Matrix3>& rotations);

/// Area-weighted unit normals.
Points normals(const Points& points, const Faces& faces);

/// The paper's frames.
std::vector<Matrix3> paper_rotations(const Region& region, const Points& rest, const Points& unrotated, double r);

}  // namespace lapedit::reference
