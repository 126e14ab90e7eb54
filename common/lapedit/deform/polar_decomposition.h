// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SVD>

#include "lapedit/base/types.h"

namespace lapedit {

/// Polar decomposition A = Q S by the singular value decomposition A = U Sigma V^T.
class PolarDecomposition {
 public:
  explicit PolarDecomposition(const Matrix3& matrix) : svd_(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV) {}

  /// Returns Q = U V^T; its determinant is -1 if A is a reflection.
  Matrix3 orthogonal() const { return svd_.matrixU() * svd_.matrixV().transpose(); }
  /// Returns S = V Sigma V^T, which is symmetric.
  Matrix3 stretch() const { return svd_.matrixV() * svd_.singularValues().asDiagonal() * svd_.matrixV().transpose(); }
  /// Returns the rotation nearest to A: Q, with the direction of the smallest singular value reversed if A is a
  /// reflection.
  Matrix3 rotation() const;

 private:
  Eigen::JacobiSVD<Matrix3> svd_;
};

/// Returns the rotation nearest to a matrix: its polar factor with determinant +1. It is the identity for zero, and
/// exactly the identity for a symmetric positive definite matrix; directions in the kernel of the matrix rotate as
/// little as possible. Regular matrices use Newton's iteration, which is several times faster; nearly singular ones
/// PolarDecomposition.
Matrix3 nearest_rotation(const Matrix3& matrix);

/// Computes rotations[i] = nearest_rotation(matrices[i]) with the same bits, several at a time if the processor can.
/// Both arrays may be the same.
void nearest_rotations(const Matrix3* matrices, int count, Matrix3* rotations);

}  // namespace lapedit
