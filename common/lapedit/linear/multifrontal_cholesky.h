// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"
#include "lapedit/linear/task_tree.h"

namespace lapedit::supernode {

/// Sparse Cholesky factorisation by fronts (Duff and Reid 1983; Liu 1992): the columns of a supernode, and what its
/// children left for the rows below them, are one dense matrix; its first columns are factored, and the rest goes on to
/// the parent. Independent branches go to different threads; the order of all sums is fixed, so the bits do not depend
/// on their number. They do on the instructions that the processor has.
///
/// @param lower      the lower half of the matrix, in the order of elimination, the entries of a column in any
/// @param pattern    of its factor. @param tree  made of the pattern
/// @param take       called once for each supernode, from any thread: its columns of L, column after
///                   column, `stride` apart; what is above the diagonal is undefined
/// @return whether the matrix is positive definite; if not, some supernodes are not taken
/// Memory: the fronts whose parents are not made yet; about a tenth of the factor.
bool multifrontal_cholesky(const SparseMatrix& lower, const SupernodalPattern& pattern, const TaskTree& tree,
                           const std::function<void(int supernode, const double* columns, int stride)>& take,
                           ThreadPool& pool);

}  // namespace lapedit::supernode
