// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SVD>

#include "lapedit/base/types.h"

namespace lapedit {

/// A = Q S, from the singular value decomposition A = U Sigma V^T.
class PolarDecomposition {
 public:
  explicit PolarDecomposition(const Matrix3& matrix) : svd_(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV) {}

  /// Q = U V^T; of determinant -1 where A mirrors.
  Matrix3 orthogonal() const { return svd_.matrixU() * svd_.matrixV().transpose(); }
  /// S = V Sigma V^T, symmetric.
  Matrix3 stretch() const { return svd_.matrixV() * svd_.singularValues().asDiagonal() * svd_.matrixV().transpose(); }
  /// The rotation nearest to A: Q, with the direction of the smallest singular value reversed where A mirrors.
  Matrix3 rotation() const;

 private:
  Eigen::JacobiSVD<Matrix3> svd_;
};

/// The rotation nearest to a matrix: its polar factor with determinant +1, the identity for zero. Directions that the
/// matrix says nothing about turn as little as the others allow; exactly the identity for a symmetric positive definite
/// matrix. Newton's iteration away from singular matrices, which is several times faster, else PolarDecomposition.
Matrix3 nearest_rotation(const Matrix3& matrix);

/// rotations[i] = nearest_rotation(matrices[i]), bit for bit, several at a time where the processor can. They may be
/// the same.
void nearest_rotations(const Matrix3* matrices, int count, Matrix3* rotations);

}  // namespace lapedit
