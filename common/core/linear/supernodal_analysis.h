// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "lapedit/base/types.h"

namespace lapedit {

/// The pattern of a supernodal factor L of a symmetric matrix, L L^T = P A P^T, in CHOLMOD's layout.
/// Supernode s has the columns columns[s] .. columns[s + 1] - 1; its rows, its own columns first and then ascending,
/// are rows[row_offsets[s] .. row_offsets[s + 1]).
struct SupernodalPattern {
  std::vector<int> order;  ///< elimination order: order[k] is the row of A eliminated k-th
  std::vector<int> columns, row_offsets, rows;

  int size() const { return columns.back(); }  ///< of the matrix
  int supernodes() const { return static_cast<int>(columns.size()) - 1; }
  int columns_of(int s) const { return columns[s + 1] - columns[s]; }
  int rows_of(int s) const { return row_offsets[s + 1] - row_offsets[s]; }
  /// Returns the number of entries, supernodes counted as dense columns. O(supernodes)
  std::size_t factor_nonzeros() const {
    std::size_t sum = 0;
    for (int s = 0; s < supernodes(); ++s) {
      sum += static_cast<std::size_t>(columns_of(s)) * static_cast<std::size_t>(rows_of(s));
    }
    return sum;
  }
};

/// Computes the elimination tree (Liu 1990), column counts without the entries (Gilbert, Ng and Peyton 1994), and
/// supernodes, merged where a few more zeros make them larger, by the rules of SuiteSparse's CHOLMOD (Chen, Davis,
/// Hager and Rajamanickam 2008): the pattern is the same as CHOLMOD's. Columns are renumbered along the tree, which
/// does not change the fill.
/// @param matrix  both halves or the lower one. @param order  a permutation, or empty: approximate minimum degree
/// Cost: about a dozen reads of the matrix, and writing the pattern.
SupernodalPattern supernodal_analysis(const SparseMatrix& matrix, const std::vector<int>& order);

/// Returns an approximate minimum degree order (Amestoy, Davis and Duff 1996).
std::vector<int> minimum_degree(const SparseMatrix& matrix);

}  // namespace lapedit
