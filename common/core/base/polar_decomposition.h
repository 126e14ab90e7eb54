// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/base/types.h"

namespace lapedit {

/// Returns the rotation nearest to a matrix A in the Frobenius norm. With the singular value decomposition A = U Sigma
/// V^T it is U V^T, with the direction of the smallest singular value reversed if A mirrors (det A < 0).
Matrix3 polar_rotation(const Matrix3& matrix);

/// Returns the rotation nearest to a matrix: its polar factor with determinant +1. It is the identity for zero, and
/// exactly the identity for a symmetric positive definite matrix; directions in the kernel of the matrix rotate as
/// little as possible.
Matrix3 nearest_rotation(const Matrix3& matrix);

/// Computes rotations[i] = nearest_rotation(matrices[i]), several at a time. Both arrays may be the same.
void nearest_rotations(const Matrix3* matrices, int count, Matrix3* rotations);

}  // namespace lapedit
