// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/polar_decomposition.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

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
  const double size = matrix.norm();
  if (!(size > 0)) {
    return Matrix3::Identity();
  }
  constexpr double kUndetermined = 1e-10;
  const Matrix3 start = matrix / size + kUndetermined * Matrix3::Identity();
  if (start == start.transpose() && start.llt().info() == Eigen::Success) {
    return Matrix3::Identity();  // positive definite: exactly the identity for vertices that have not moved
  }
  // Newton's iteration for the polar factor (Higham 1986) is X <- (g X + X^-T / g) / 2 with g^2 = |X^-T| / |X|. It is
  // accurate and fast unless the matrix is nearly singular; the SVD handles such matrices.
  constexpr double kSafeDeterminant = 1e-4;
  if (start.determinant() > kSafeDeterminant) {
    Matrix3 x = start;
    for (int step = 0; step < 12; ++step) {
      const Matrix3 inverse_transposed = x.inverse().transpose();
      const double gamma = std::sqrt(inverse_transposed.norm() / x.norm());
      const Matrix3 next = 0.5 * (gamma * x + inverse_transposed / gamma);
      const double change = (next - x).squaredNorm();
      x = next;
      if (change < 1e-26) {
        return x;
      }
    }
  }
  return polar_rotation(start);
}

}  // namespace lapedit
