// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace lapedit::supernode {

constexpr int kFrontLanes = 8;  ///< the number of rows of a front is a multiple of it

/// Performs the first steps of a dense Cholesky factorisation in place: the first `columns` columns become those of L,
/// and their products are subtracted from the columns to their right.
/// @param front  size x size, column by column, `stride` (a multiple of kFrontLanes) apart; the lower half. Entries
/// above the diagonal and behind a column are overwritten.
/// @return whether all pivots are positive
using FrontalKernel = bool (*)(double* front, int stride, int size, int columns);

/// Returns the kernel for this processor.
FrontalKernel best_frontal_kernel();

}  // namespace lapedit::supernode
