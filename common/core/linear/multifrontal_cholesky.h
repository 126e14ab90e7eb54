// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"
#include "lapedit/linear/frontal_kernels.h"
#include "lapedit/linear/task_tree.h"

namespace lapedit::supernode {

/// Multifrontal sparse Cholesky factorisation (Duff and Reid 1983; Liu 1992): the columns of a supernode and the
/// contributions of its children form a dense matrix; its first columns are factored, and the remainder is the
/// contribution to the parent. Different threads factor independent branches; the order of all sums is fixed, so the
/// bits do not depend on the number of threads. Whether they depend on the processor's instructions is up to the
/// kernel.
///
/// @param lower      the lower half of a symmetric positive definite matrix, in the order of elimination; the entries
///                   of a column in any order
/// @param pattern    the pattern of its factor
/// @param tree       the tree of that pattern
/// @param take       called once for each supernode, from any thread, with its columns of L, `stride` apart; entries
/// above the diagonal are undefined
/// @return whether the matrix is positive definite; if not, `take` is not called for some supernodes
/// Memory: the fronts whose parents are pending; about a tenth of the factor.
bool multifrontal_cholesky(const SparseMatrix& lower, const SupernodalPattern& pattern, const TaskTree& tree,
                           const std::function<void(int supernode, const double* columns, int stride)>& take,
                           FrontalKernel kernel, ThreadPool& pool);

}  // namespace lapedit::supernode
