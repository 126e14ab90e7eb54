// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

// The inner loops of SupernodalSolver, over one supernode at a time.
//
// Layout. A supernode's columns are cut into blocks of kWide. A block holds the inverse of its triangle and, below it,
// panels of kTall rows, each column by column. Both passes then read the factor from one end to the other: forward, the
// lanes of a vector are rows of a panel and y of the block's columns is broadcast; backward, the block's sums stay in
// registers while its panels go by.
//
// Local vectors of a supernode are three arrays (x, y, z), `pad` apart, of its rows and kWide + kTall more, zero beyond
// the rows.

namespace lapedit::supernode {

constexpr int kWide = 8;     // columns of a block
constexpr int kTall = 8;     // rows of a panel
constexpr int kAhead = 512;  // bytes to prefetch ahead, since the hardware stops at the end of a small page

template <typename Scalar>
struct Kernels {
  /// Solves with all blocks of a supernode. @param v  its local vectors
  void (*forward)(const Scalar* tiles, int columns, int rows, Scalar* v, int pad);
  /// @param tiles  the end of the supernode's tiles
  void (*backward)(const Scalar* tiles, int columns, int rows, Scalar* v, int pad);
  /// Copies a supernode's values into tiles and inverts the triangles. @param values  its columns, `stride` apart
  void (*write_tiles)(const double* values, int stride, int columns, int rows, Scalar* out);
};

/// Returns the kernels for this processor.
template <typename Scalar>
Kernels<Scalar> best_kernels();

/// Returns the number of values of a supernode's tiles.
std::size_t tiles_of(int columns, int rows);

}  // namespace lapedit::supernode
