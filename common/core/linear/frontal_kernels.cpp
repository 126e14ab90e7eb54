// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/frontal_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "lapedit/base/progress.h"
#include "lapedit/base/simd.h"

namespace lapedit::supernode {
namespace {

constexpr int kLanes = kFrontLanes;
constexpr int kBlock = 8;      // columns solved at a time
constexpr int kPanel = 64;     // columns whose products are subtracted at a time
constexpr int kProducts = 32;  // vectors of products for a unit of work, see checkpoint()

using FrontLanes = Simd<double, kLanes>::Vector;

constexpr std::ptrdiff_t kStep = kLanes;

/// Subtracts from the Width columns that start at `to` the products of the `depth` columns that start at `by`, for Tall
/// vectors of their rows.
/// @param rows  entries of the columns `by` in the rows of the diagonal: Width for each of them
template <int Tall, int Width>
LAPEDIT_INLINE void subtract_tile(double* to, const double* by, const double* rows, int stride, int depth) {
  FrontLanes sum[Width][Tall];
  LAPEDIT_UNROLL(8)
  for (int j = 0; j < Width; ++j) {
    LAPEDIT_UNROLL(4)
    for (int v = 0; v < Tall; ++v) {
      sum[j][v] = load<FrontLanes>(to + static_cast<std::size_t>(j) * stride + v * kStep);
    }
  }
  for (int p = 0; p < depth; ++p) {
    FrontLanes column[Tall];
    LAPEDIT_UNROLL(4)
    for (int v = 0; v < Tall; ++v) {
      column[v] = load<FrontLanes>(by + v * kStep);
    }
    LAPEDIT_UNROLL(8)
    for (int j = 0; j < Width; ++j) {
      LAPEDIT_UNROLL(4)
      for (int v = 0; v < Tall; ++v) {
        sum[j][v] -= rows[j] * column[v];
      }
    }
    by += stride;
    rows += Width;
  }
  LAPEDIT_UNROLL(8)
  for (int j = 0; j < Width; ++j) {
    LAPEDIT_UNROLL(4)
    for (int v = 0; v < Tall; ++v) {
      store(to + static_cast<std::size_t>(j) * stride + v * kStep, sum[j][v]);
    }
  }
}

/// Calls subtract_tile() for all rows of Width columns, from the diagonal down.
template <int Tall, int Width>
LAPEDIT_INLINE void subtract_columns(double* front, int stride, int column, int by, int depth) {
  double rows[kPanel * Width];
  const double* const from = front + static_cast<std::size_t>(by) * stride;
  for (int p = 0; p < depth; ++p) {
    for (int j = 0; j < Width; ++j) {
      rows[p * Width + j] = from[static_cast<std::size_t>(p) * stride + column + j];
    }
  }
  double* const to = front + static_cast<std::size_t>(column) * stride;
  int row = column / kLanes * kLanes;
  for (; row + Tall * kLanes <= stride; row += Tall * kLanes) {
    subtract_tile<Tall, Width>(to + row, from + row, rows, stride, depth);
  }
  for (; row < stride; row += kLanes) {
    subtract_tile<1, Width>(to + row, from + row, rows, stride, depth);
  }
}

template <int Tall, int Width>
LAPEDIT_INLINE void subtract(double* front, int stride, int first, int last, int by, int depth) {
  Checkpoints checkpoints;
  int column = first;
  for (; depth > 0 && column + Width <= last; column += Width) {
    subtract_columns<Tall, Width>(front, stride, column, by, depth);
    checkpoints((stride - column) * depth / kProducts);
  }
  for (; depth > 0 && column < last; ++column) {
    subtract_columns<Tall, 1>(front, stride, column, by, depth);
  }
}

/// Factors the triangle of a few columns and solves for the rows below, including those of the triangle.
LAPEDIT_INLINE bool solve_block(double* front, int stride, int first, int width) {
  double triangle[kBlock][kBlock], inverse[kBlock];
  double* const block = front + static_cast<std::size_t>(first) * stride;
  for (int j = 0; j < width; ++j) {
    for (int i = j; i < width; ++i) {
      double sum = block[static_cast<std::size_t>(j) * stride + first + i];
      for (int p = 0; p < j; ++p) {
        sum -= triangle[i][p] * triangle[j][p];
      }
      if (i == j) {
        if (!(sum > 0)) {
          return false;
        }
        triangle[j][j] = std::sqrt(sum);
        inverse[j] = 1 / triangle[j][j];
      } else {
        triangle[i][j] = sum * inverse[j];
      }
    }
  }
  for (int row = first / kLanes * kLanes; row < stride; row += kLanes) {
    FrontLanes x[kBlock];
    for (int j = 0; j < width; ++j) {
      x[j] = load<FrontLanes>(block + static_cast<std::size_t>(j) * stride + row);
      for (int p = 0; p < j; ++p) {
        x[j] -= triangle[j][p] * x[p];
      }
      x[j] *= inverse[j];
      store(block + static_cast<std::size_t>(j) * stride + row, x[j]);
    }
  }
  return true;
}

template <int Tall, int Width>
LAPEDIT_INLINE bool factor_front(double* front, int stride, int size, int columns) {
  for (int panel = 0; panel < columns; panel += kPanel) {
    const int end = std::min(panel + kPanel, columns);
    for (int first = panel; first < end; first += kBlock) {
      const int last = std::min(first + kBlock, end);
      subtract<Tall, Width>(front, stride, first, last, panel, first - panel);
      if (!solve_block(front, stride, first, last - first)) {
        return false;
      }
    }
    subtract<Tall, Width>(front, stride, end, size, panel, end - panel);
  }
  return true;
}

bool factor_plain(double* front, int stride, int size, int columns) {
  return factor_front<1, 2>(front, stride, size, columns);
}
LAPEDIT_AVX2 bool factor_avx2(double* front, int stride, int size, int columns) {
  return factor_front<1, 4>(front, stride, size, columns);
}
LAPEDIT_AVX512 bool factor_avx512(double* front, int stride, int size, int columns) {
  return factor_front<3, 8>(front, stride, size, columns);
}

}  // namespace

FrontalKernel best_frontal_kernel() {
  return for_processor(factor_plain, factor_avx2, factor_avx512);
}

}  // namespace lapedit::supernode
