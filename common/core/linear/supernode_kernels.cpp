// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/supernode_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "lapedit/base/simd.h"

namespace lapedit::supernode {
namespace {

template <typename Scalar>
using Lanes = Simd<Scalar, kTall>;

template <typename Scalar>
LAPEDIT_INLINE void fetch(const Scalar* position) {
  prefetch(reinterpret_cast<const char*>(position) + kAhead);
}

/// Returns the sums over the lanes of eight vectors, one per lane.
template <typename Vector>
LAPEDIT_INLINE Vector lane_sums(const Vector* s) {
  Vector t[4], u[2];
  LAPEDIT_UNROLL(4)
  for (std::ptrdiff_t k = 0; k < 4; ++k) {
    t[k] = shuffle<0, 8, 2, 10, 4, 12, 6, 14>(s[2 * k], s[2 * k + 1]) +
           shuffle<1, 9, 3, 11, 5, 13, 7, 15>(s[2 * k], s[2 * k + 1]);
  }
  LAPEDIT_UNROLL(2)
  for (std::ptrdiff_t k = 0; k < 2; ++k) {
    u[k] = shuffle<0, 1, 8, 9, 4, 5, 12, 13>(t[2 * k], t[2 * k + 1]) +
           shuffle<2, 3, 10, 11, 6, 7, 14, 15>(t[2 * k], t[2 * k + 1]);
  }
  return shuffle<0, 1, 2, 3, 8, 9, 10, 11>(u[0], u[1]) + shuffle<4, 5, 6, 7, 12, 13, 14, 15>(u[0], u[1]);
}

// The compiler must unroll loops over lanes, columns and right-hand sides, so that their sums stay in registers.

/// Solves one block of L y = b: y = T^-1 v with T the block's triangle, then v below -= L y. @return the end of the
/// block
template <typename Scalar, int Width>
LAPEDIT_INLINE const Scalar* forward_block(const Scalar* block, int panels, Scalar* v, int pad) {
  using Vector = typename Lanes<Scalar>::Vector;
  Scalar y[3][kWide];
  Vector start[3] = {};
  LAPEDIT_UNROLL(8)
  for (int j = 0; j < Width; ++j) {
    const Vector column = load<Vector>(block + j * kWide);
    LAPEDIT_UNROLL(3)
    for (int r = 0; r < 3; ++r) {
      start[r] += column * v[r * pad + j];
    }
  }
  LAPEDIT_UNROLL(3)
  for (int r = 0; r < 3; ++r) {
    std::memcpy(y[r], &start[r], sizeof start[r]);
    std::memcpy(v + r * pad, y[r], Width * sizeof(Scalar));
  }
  const Scalar* tile = block + Width * kWide;
  Scalar* below = v + Width;
  for (int p = 0; p < panels; ++p) {
    Vector sum[3];
    LAPEDIT_UNROLL(3)
    for (int r = 0; r < 3; ++r) {
      sum[r] = load<Vector>(below + r * pad);
    }
    LAPEDIT_UNROLL(8)
    for (int j = 0; j < Width; ++j) {
      const Vector column = load<Vector>(tile + j * kTall);
      fetch(tile + j * kTall);
      LAPEDIT_UNROLL(3)
      for (int r = 0; r < 3; ++r) {
        sum[r] -= column * y[r][j];
      }
    }
    LAPEDIT_UNROLL(3)
    for (int r = 0; r < 3; ++r) {
      std::memcpy(below + r * pad, &sum[r], sizeof sum[r]);
    }
    tile += Width * kTall;
    below += kTall;
  }
  return tile;
}

/// Computes the sums of a panel's column times the rows below, for Count columns of a block from `first` on.
template <typename Scalar, int Width, int Count>
LAPEDIT_INLINE void backward_sums(const Scalar* tile, int panels, const Scalar* below, int pad,
                                  typename Lanes<Scalar>::Vector (*sums)[kWide]) {
  using Vector = typename Lanes<Scalar>::Vector;
  Vector sum[3][Count] = {};
  for (int p = 0; p < panels; ++p) {
    Vector x[3];
    LAPEDIT_UNROLL(3)
    for (int r = 0; r < 3; ++r) {
      x[r] = load<Vector>(below + r * pad);
    }
    LAPEDIT_UNROLL(8)
    for (int j = 0; j < Count; ++j) {
      const Vector column = load<Vector>(tile + j * kTall);
      fetch(tile + j * kTall);
      LAPEDIT_UNROLL(3)
      for (int r = 0; r < 3; ++r) {
        sum[r][j] += column * x[r];
      }
    }
    tile += Width * kTall;
    below += kTall;
  }
  LAPEDIT_UNROLL(3)
  for (int r = 0; r < 3; ++r) {
    LAPEDIT_UNROLL(8)
    for (int j = 0; j < Count; ++j) {
      sums[r][j] = sum[r][j];
    }
  }
}

/// Solves one block of L^T x = y: v of the block = T^-T (v - L^T v below), Group columns at a time, as registers allow.
template <typename Scalar, int Width, int Group>
LAPEDIT_INLINE void backward_block(const Scalar* block, int panels, Scalar* v, int pad) {
  using Vector = typename Lanes<Scalar>::Vector;
  Vector sums[3][kWide] = {};
  constexpr int kWhole = Width / Group * Group;
  const Scalar* const tiles = block + Width * kWide;
  LAPEDIT_UNROLL(8)
  for (int first = 0; first < kWhole; first += Group) {
    Vector partial[3][kWide];
    backward_sums<Scalar, Width, Group>(tiles + first * kTall, panels, v + Width, pad, partial);
    LAPEDIT_UNROLL(3)
    for (int r = 0; r < 3; ++r) {
      LAPEDIT_UNROLL(8)
      for (int j = 0; j < Group; ++j) {
        sums[r][first + j] = partial[r][j];
      }
    }
  }
  if constexpr (kWhole < Width) {
    Vector partial[3][kWide];
    backward_sums<Scalar, Width, Width - kWhole>(tiles + kWhole * kTall, panels, v + Width, pad, partial);
    LAPEDIT_UNROLL(3)
    for (int r = 0; r < 3; ++r) {
      LAPEDIT_UNROLL(8)
      for (int j = kWhole; j < Width; ++j) {
        sums[r][j] = partial[r][j - kWhole];
      }
    }
  }
  LAPEDIT_UNROLL(3)
  for (int r = 0; r < 3; ++r) {
    // Lanes beyond Width are rows below; the triangle has zeros there.
    const Vector y = load<Vector>(v + r * pad) - lane_sums(sums[r]);
    Vector products[kWide] = {};
    LAPEDIT_UNROLL(8)
    for (int j = 0; j < Width; ++j) {
      products[j] = load<Vector>(block + j * kWide) * y;
    }
    const Vector result = lane_sums(products);
    std::memcpy(v + r * pad, &result, Width * sizeof(Scalar));
  }
}

constexpr int panels_below(int rows_below) {
  return (rows_below + kTall - 1) / kTall;
}

/// Calls a function with the width as a type, for a width of 1 to kWide.
template <int Width = 1, class Function>
LAPEDIT_INLINE void with_width(int width, const Function& function) {
  if constexpr (Width < kWide) {
    if (width > Width) {
      with_width<Width + 1>(width, function);
      return;
    }
  }
  function(std::integral_constant<int, Width>());
}

template <typename Scalar>
LAPEDIT_INLINE void forward_supernode(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  int first = 0;
  for (; first + kWide <= columns; first += kWide) {
    tiles = forward_block<Scalar, kWide>(tiles, panels_below(rows - first - kWide), v + first, pad);
  }
  if (first < columns) {
    with_width(columns - first, [&](auto tag) LAPEDIT_ALWAYS_INLINE {
      forward_block<Scalar, decltype(tag)::value>(tiles, panels_below(rows - columns), v + first, pad);
    });
  }
}

/// Returns the number of values of one block's tiles.
constexpr std::size_t block_size(int width, int rows_below) {
  return static_cast<std::size_t>(width) * (kWide + kTall * static_cast<std::size_t>(panels_below(rows_below)));
}

template <typename Scalar, int Group>
LAPEDIT_INLINE void backward_supernode(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  const int rest = columns % kWide;
  int first = columns - rest;
  if (rest > 0) {
    end -= block_size(rest, rows - columns);
    with_width(rest, [&](auto tag) LAPEDIT_ALWAYS_INLINE {
      backward_block<Scalar, decltype(tag)::value, Group>(end, panels_below(rows - columns), v + first, pad);
    });
  }
  while (first > 0) {
    first -= kWide;
    const int below = rows - first - kWide;
    end -= block_size(kWide, below);
    backward_block<Scalar, kWide, Group>(end, panels_below(below), v + first, pad);
  }
}

template <typename Scalar>
void forward_plain(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  forward_supernode(tiles, columns, rows, v, pad);
}
template <typename Scalar>
void backward_plain(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  backward_supernode<Scalar, 2>(end, columns, rows, v, pad);
}

template <typename Scalar>
LAPEDIT_AVX2 void forward_avx2(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  forward_supernode(tiles, columns, rows, v, pad);
}
template <typename Scalar>
LAPEDIT_AVX2 void backward_avx2(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  backward_supernode<Scalar, sizeof(Scalar) == 8 ? 2 : 4>(end, columns, rows, v, pad);
}
template <typename Scalar>
LAPEDIT_AVX512 void forward_avx512(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  forward_supernode(tiles, columns, rows, v, pad);
}
template <typename Scalar>
LAPEDIT_AVX512 void backward_avx512(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  backward_supernode<Scalar, 8>(end, columns, rows, v, pad);
}

/// Stores tiny numbers as zero in single precision, since denormal numbers are slow. They are far below its rounding.
template <typename Scalar>
Scalar stored(double value) {
  constexpr double kNothing = sizeof(Scalar) < sizeof(double) ? 1e-25 : 0;
  return std::abs(value) > kNothing ? static_cast<Scalar>(value) : Scalar(0);
}

/// Writes tiles, with the inverse of each triangle T computed column by column: t'_jj = 1 / t_jj, t'_ij = -(sum_{j <= k
/// < i} t_ik t'_kj) / t_ii.
template <typename Scalar>
void write_tiles(const double* values, int stride, int columns, int rows, Scalar* out) {
  for (int first = 0; first < columns; first += kWide) {
    const int width = std::min(kWide, columns - first);
    double inverse[kWide][kWide] = {};  // [column][row]
    for (int j = 0; j < width; ++j) {
      inverse[j][j] = 1 / values[static_cast<std::size_t>(first + j) * stride + first + j];
      for (int i = j + 1; i < width; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) {
          sum += values[static_cast<std::size_t>(first + k) * stride + first + i] * inverse[j][k];
        }
        inverse[j][i] = -sum / values[static_cast<std::size_t>(first + i) * stride + first + i];
      }
    }
    for (int j = 0; j < width; ++j) {
      for (int i = 0; i < kWide; ++i) {
        *out++ = stored<Scalar>(inverse[j][i]);
      }
    }
    for (int row = first + width; row < rows; row += kTall) {
      const int tall = std::min(kTall, rows - row);
      for (int j = 0; j < width; ++j) {
        const double* column = values + static_cast<std::size_t>(first + j) * stride + row;
        for (int i = 0; i < tall; ++i) {
          out[i] = stored<Scalar>(column[i]);
        }
        for (int i = tall; i < kTall; ++i) {
          out[i] = 0;
        }
        out += kTall;
      }
    }
  }
}

}  // namespace

template <typename Scalar>
Kernels<Scalar> best_kernels() {
  return {for_processor(forward_plain<Scalar>, forward_avx2<Scalar>, forward_avx512<Scalar>),
          for_processor(backward_plain<Scalar>, backward_avx2<Scalar>, backward_avx512<Scalar>), write_tiles<Scalar>};
}

template Kernels<float> best_kernels();
template Kernels<double> best_kernels();

std::size_t tiles_of(int columns, int rows) {
  std::size_t size = 0;
  for (int first = 0; first < columns; first += kWide) {
    const int width = std::min(kWide, columns - first);
    size += block_size(width, rows - first - width);
  }
  return size;
}

}  // namespace lapedit::supernode
