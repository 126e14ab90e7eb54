// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/polar_decomposition.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace lapedit {

Matrix3 polar_rotation(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 factor = svd.matrixU() * svd.matrixV().transpose();
  if (factor.determinant() > 0) {
    return factor;
  }
  Matrix3 u = svd.matrixU();
  u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

Matrix3 nearest_rotation(const Matrix3& matrix) {
  Matrix3 rotation;
  nearest_rotations(&matrix, 1, &rotation);
  return rotation;
}

}  // namespace lapedit
