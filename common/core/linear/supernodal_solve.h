// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"
#include "lapedit/linear/supernodal_analysis.h"

namespace lapedit {

/// L^-1 e for a unit vector e: half a column of A^-1, whose entries are products of two of these.
struct HalfColumn {
  struct Block {
    int first, size;
  };
  std::vector<Block> blocks;   ///< rows in the factor's order, ascending, outside of which it is zero
  std::vector<double> values;  ///< of all blocks
};

/// Solves with a supernodal factor for three right-hand sides at once, in about the time of reading the factor twice.
///
/// The factor is copied into tiles in the order in which a solve reads them, with small triangles inverted, in double
/// or single precision. Different threads take independent branches of the elimination tree; the order of sums, and so
/// the bits of the result, do not depend on the number of threads. They do depend on the processor's instructions
/// (AVX-512, AVX2, neither).
template <typename Scalar>
class SupernodalSolver {
 public:
  /// Factors a matrix. @param lower  its lower half, in the order of elimination; entries of a column in any order
  /// @param pattern  of its factor; not kept.
  SupernodalSolver(const SupernodalPattern& pattern, const SparseMatrix& lower, ThreadPool& pool);
  bool positive_definite() const;  ///< otherwise solving is not possible
  /// Shares the immutable tiles and has scratch of its own: both can work concurrently, each with its own pool. O(1).
  SupernodalSolver(const SupernodalSolver& other, const ThreadPool& pool);
  ~SupernodalSolver();

  /// Solves with the factored matrix A in place: x = A^-1 x. A is symmetric positive definite.
  /// @param x  n x 3, row after row, in the factor's order: row k is the k-th vertex eliminated
  /// Allocates nothing. One call at a time.
  void solve(Scalar* x, ThreadPool& pool);

  /// Returns L^-1 e for the unit vectors e of rows. Cost: reading the supernodes between these rows and the root.
  std::vector<HalfColumn> half_columns(const std::vector<int>& rows, ThreadPool& pool) const;

 private:
  struct Tiles;
  struct Passes;
  std::shared_ptr<const Tiles> tiles_;
  std::unique_ptr<Passes> passes_;
};

}  // namespace lapedit
