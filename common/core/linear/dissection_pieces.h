// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lapedit/base/compressed_rows.h"

// Shared by nested_dissection.cpp and minimum_vertex_separator.cpp.

namespace lapedit::dissection {

constexpr double kBalance = 5;  // penalty of an uneven division, see score(); found by experiment
constexpr double kLeastPart =
    0.02;  // a side smaller than this, or a separator larger than the next constant, is not useful
constexpr double kMostSeparated = 0.6;

/// Vertices to be ordered, surrounded by ghosts: adjacent vertices of separators above. Two
/// vertices with a common ghost are neighbours in the matrix's graph.
struct Piece {
  int inner = 0;            ///< vertices 0 .. inner - 1 are to be ordered, the others are ghosts
  std::vector<int> vertex;  ///< their numbers in the whole graph
  CompressedRows next;      ///< first neighbours; a ghost's are inner vertices only
  std::vector<float> at;    ///< coordinates, three each

  int size() const { return static_cast<int>(vertex.size()); }
};

enum Side : std::uint8_t { kLow, kHigh, kSeparator, kGhost };

using Counts = std::array<int, 4>;  // vertices per side

/// Scratch memory of one thread. The first arrays have an entry per vertex of a piece.
struct Scratch {
  std::vector<std::uint8_t> side;      // Side
  std::vector<std::uint8_t> position;  // bin along the axis; then whether beyond the cut
  std::vector<float> along;            // coordinate on the axis
  std::vector<int> queue, level;       // of the breadth-first search
  std::vector<int> local;              // number in a piece
  std::vector<int> from, values;       // of a piece
  std::vector<std::uint64_t> nets;     // of a leaf

  // Of a band, see minimum_vertex_separator.cpp.
  std::vector<int> band, offsets, members, in, out, depth, arc, path;
  std::vector<std::uint8_t> ends, before;

  void fit(int size) {
    if (static_cast<int>(side.size()) < size) {
      side.resize(size);
      position.resize(size);
      along.resize(size);
      queue.resize(size);
      level.resize(size);
      local.resize(size);
    }
  }
};

/// Returns whether a division is worth pursuing.
inline bool is_division(const Counts& counts) {
  const int n = counts[kLow] + counts[kHigh] + counts[kSeparator];
  return std::min(counts[kLow], counts[kHigh]) >= kLeastPart * n && counts[kSeparator] <= kMostSeparated * n;
}

/// Returns the cost of a separator per vertex of the piece: the entries of its triangle, and more for an uneven
/// division, whose larger side needs more levels.
inline double score(double low, double high, double separator) {
  low = std::max(low, 0.0);
  high = std::max(high, 0.0);
  const double fraction = (low + 0.5) / (low + high + 1);
  const double entropy = -(fraction * std::log2(fraction) + (1 - fraction) * std::log2(1 - fraction));
  return 0.5 * separator * separator / (low + high + separator) + kBalance * (1 - entropy);
}

/// Improves a separator or a division: finds the smallest separator among `layers` layers of vertices on each side by a
/// maximum flow (Dinic 1970). Time is proportional to the band's entries, times the few phases that a flow needs in
/// practice; `scratch` grows as needed.
/// @param scratch  its `side` is the division, per vertex of the piece; changed if that improves its score
/// @param counts   vertices per side, likewise
void improve_separator(const Piece& piece, Scratch& scratch, Counts& counts, int layers);

}  // namespace lapedit::dissection
