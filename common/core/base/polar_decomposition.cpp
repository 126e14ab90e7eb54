// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/base/simd.h"

// Newton's iteration for the polar factor (N. Higham 1986), on eight matrices at a time: X <- (g X + X^-T / g) / 2 with
// g^2 = |X^-T| / |X|. The operations are the same on every processor, without contraction, and so are the bits.

namespace lapedit {
namespace {

constexpr int kLanes = 8;

using Lanes = Simd<double, kLanes>::Vector;
using Mask = Simd<std::int64_t, kLanes>::Vector;

/// Eight 3 x 3 matrices, one per lane. The entries are stored column by column, as in Eigen.
struct Matrices {
  Lanes m[9];

  LAPEDIT_INLINE Lanes operator()(int row, int column) const { return m[3 * column + row]; }
  LAPEDIT_INLINE Matrix3 at(int lane) const {
    Matrix3 matrix;
    for (int k = 0; k < 9; ++k) {
      matrix.data()[k] = m[k][lane];
    }
    return matrix;
  }
};

/// Adds the squares in the order in which Eigen sums nine squares with vectors of two.
LAPEDIT_INLINE Lanes squared_norm(const Matrices& a) {
  const auto square = [&a](int k) LAPEDIT_ALWAYS_INLINE { return a.m[k] * a.m[k]; };
  return (((square(0) + square(2)) + (square(4) + square(6))) + ((square(1) + square(3)) + (square(5) + square(7)))) +
         square(8);
}

LAPEDIT_INLINE Lanes square_root(Lanes a) {
  for (int lane = 0; lane < kLanes; ++lane) {
    a[lane] = std::sqrt(a[lane]);
  }
  return a;
}

LAPEDIT_INLINE Lanes cofactor(const Matrices& a, int i, int j) {
  const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  return a(i1, j1) * a(i2, j2) - a(i1, j2) * a(i2, j1);
}

LAPEDIT_INLINE Matrices inverse_transposed(const Matrices& a) {
  Matrices result;
  LAPEDIT_UNROLL(9)
  for (int k = 0; k < 9; ++k) {
    result.m[k] = cofactor(a, k % 3, k / 3);
  }
  const Lanes factor = 1 / ((result.m[0] * a.m[0] + result.m[1] * a.m[1]) + result.m[2] * a.m[2]);
  LAPEDIT_UNROLL(9)
  for (int k = 0; k < 9; ++k) {
    result.m[k] *= factor;
  }
  return result;
}

LAPEDIT_INLINE Lanes determinant(const Matrices& a) {
  const auto term = [&a](int i, int j, int k)
                        LAPEDIT_ALWAYS_INLINE { return a(0, i) * (a(1, j) * a(2, k) - a(1, k) * a(2, j)); };
  return term(0, 1, 2) - term(1, 0, 2) + term(2, 0, 1);
}

/// Replaces the matrices of open lanes by their nearest rotations. @return per lane, whether the iteration has
/// converged
LAPEDIT_INLINE Mask iterate(Matrices& x, Mask open) {
  Mask settled = {};
  for (int step = 0; step < 12; ++step) {
    const Mask left = open & ~settled;
    std::int64_t any = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      any |= left[lane];
    }
    if (any == 0) {
      break;
    }
    const Matrices back = inverse_transposed(x);
    const Lanes gamma = square_root(square_root(squared_norm(back)) / square_root(squared_norm(x)));
    Matrices next, change;
    LAPEDIT_UNROLL(9)
    for (int k = 0; k < 9; ++k) {
      next.m[k] = 0.5 * (gamma * x.m[k] + back.m[k] / gamma);
      change.m[k] = next.m[k] - x.m[k];
      x.m[k] = select(settled, x.m[k], next.m[k]);
    }
    settled |= open & (squared_norm(change) < 1e-26);
  }
  return settled;
}

/// The iteration is accurate and fast unless a matrix is nearly singular; the SVD handles such matrices.
LAPEDIT_INLINE void rotate_all(const Matrix3* matrices, int count, Matrix3* rotations) {
  constexpr double kUndetermined = 1e-10, kSafeDeterminant = 1e-4;
  for (int first = 0; first < count; first += kLanes) {
    const int lanes = std::min(kLanes, count - first);
    Matrices start;
    for (int k = 0; k < 9; ++k) {
      for (int lane = 0; lane < kLanes; ++lane) {
        start.m[k][lane] = matrices[first + std::min(lane, lanes - 1)].data()[k];
      }
    }
    const Lanes size = square_root(squared_norm(start));
    LAPEDIT_UNROLL(9)
    for (int k = 0; k < 9; ++k) {
      start.m[k] = start.m[k] / size + (k % 4 == 0 ? kUndetermined : 0);
    }
    // Exactly the identity for vertices that have not moved, whose matrices are symmetric and positive definite.
    Mask stays = (start(0, 1) == start(1, 0)) & (start(0, 2) == start(2, 0)) & (start(1, 2) == start(2, 1));
    for (int lane = 0; lane < kLanes; ++lane) {
      stays[lane] = !(size[lane] > 0) || (stays[lane] != 0 && start.at(lane).llt().info() == Eigen::Success) ? -1 : 0;
    }
    Matrices x = start;
    const Mask settled = iterate(x, (determinant(start) > kSafeDeterminant) & ~stays);
    for (int lane = 0; lane < lanes; ++lane) {
      rotations[first + lane] = stays[lane] != 0     ? Matrix3(Matrix3::Identity())
                                : settled[lane] != 0 ? x.at(lane)
                                                     : polar_rotation(start.at(lane));
    }
  }
}

void rotate_plain(const Matrix3* matrices, int count, Matrix3* rotations) {
  rotate_all(matrices, count, rotations);
}
LAPEDIT_AVX2 void rotate_avx2(const Matrix3* matrices, int count, Matrix3* rotations) {
  rotate_all(matrices, count, rotations);
}
LAPEDIT_AVX512 void rotate_avx512(const Matrix3* matrices, int count, Matrix3* rotations) {
  rotate_all(matrices, count, rotations);
}

}  // namespace

void nearest_rotations(const Matrix3* matrices, int count, Matrix3* rotations) {
  for_processor(rotate_plain, rotate_avx2, rotate_avx512)(matrices, count, rotations);
}

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
