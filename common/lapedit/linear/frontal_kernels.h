// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace lapedit::supernode {

constexpr int kFrontLanes = 8;  ///< rows of a front are a multiple of it

/// The first steps of a dense Cholesky factorisation, in place: the first `columns` columns become those of L, and what
/// is right of them loses their products.
/// @param front  size x size, column by column, `stride` (a multiple of kFrontLanes) apart; the lower half. What is
/// above
///               the diagonal and behind a column is written to.
/// @return whether all pivots are positive
using FrontalKernel = bool (*)(double* front, int stride, int size, int columns);

/// For this processor.
FrontalKernel best_frontal_kernel();

}  // namespace lapedit::supernode
