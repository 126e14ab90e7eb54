// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>

#include "lapedit/base/thread_pool.h"
#include "lapedit/base/types.h"
#include "lapedit/linear/supernodal_analysis.h"

namespace lapedit {

/// Solves with a supernodal factor for three right-hand sides at once, at the pace of reading the factor twice.
///
/// The factor is copied into tiles in the order in which a solve reads them, with small triangles inverted, in double
/// or single precision. Independent branches of the elimination tree go to different threads; sums are taken in an
/// order that does not depend on their number, so neither do the bits of the result. They do depend on the
/// instructions that the processor has (AVX-512, AVX2, neither).
template <typename Scalar>
class SupernodalSolver {
 public:
  /// Factors a matrix. @param lower  its lower half, in the order of elimination, the entries of a column in any
  /// @param pattern  of its factor; not kept
  SupernodalSolver(const SupernodalPattern& pattern, const SparseMatrix& lower, ThreadPool& pool);
  bool positive_definite() const;  ///< else there is nothing to solve with
  /// Shares the tiles, which never change, and has scratch of its own: both can be at work at a time, each on a pool of
  /// its own. O(1).
  SupernodalSolver(const SupernodalSolver& other, const ThreadPool& pool);
  ~SupernodalSolver();

  /// x = A^-1 x.
  /// @param x  n x 3, row after row, in the factor's order: row k is the k-th vertex eliminated
  /// Nothing is allocated. One call at a time.
  void solve(Scalar* x, ThreadPool& pool);

 private:
  struct Tiles;
  struct Passes;
  std::shared_ptr<const Tiles> tiles_;
  std::unique_ptr<Passes> passes_;
};

}  // namespace lapedit
