// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SparseCore>
#include <cmath>

namespace lapedit {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
/// An affine map x -> L x + t, stored as the upper three rows of a 4 x 4 matrix.
using Affine = Eigen::Transform<double, 3, Eigen::AffineCompact>;
/// n x 3, one point or vector per row, model units.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// m x 3, three vertex numbers per row.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// A sparse matrix, stored by columns.
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// Returns the largest length of a row; 0 without rows.
inline double largest_row(const Points& points) {
  return points.rows() > 0 ? std::sqrt(points.rowwise().squaredNorm().maxCoeff()) : 0;
}

}  // namespace lapedit
