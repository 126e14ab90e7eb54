// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/types.h"
#include "lapedit/linear/supernodal_pattern.h"

namespace lapedit {

/// The elimination tree (Liu 1990), its columns' counts without their entries (Gilbert, Ng and Peyton 1994), and
/// supernodes, joined where a few zeros more make them larger, by the rules of SuiteSparse's CHOLMOD (Chen, Davis,
/// Hager and Rajamanickam 2008): the same pattern as it finds. Columns are renumbered along the tree, which changes no
/// fill.
/// @param matrix  both halves or the lower one. @param order  a permutation, or empty: approximate minimum degree
/// Cost: about that of reading the matrix a dozen times, and writing the pattern.
SupernodalPattern supernodal_analysis(const SparseMatrix& matrix, const std::vector<int>& order);

/// Approximate minimum degree (Amestoy, Davis and Duff 1996).
std::vector<int> minimum_degree(const SparseMatrix& matrix);

}  // namespace lapedit
