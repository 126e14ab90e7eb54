// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// One 3 x 3 matrix per node of a graph, averaged over the nodes' neighbours. Source: this project. The averages keep
/// details from tilting the rotations that are fitted to the matrices.
class MatrixAverages {
 public:
  MatrixAverages() = default;
  explicit MatrixAverages(int count) { resize(count); }
  void resize(int count) {
    current_.resize(kStride * static_cast<std::size_t>(count));
    other_.resize(current_.size());
  }

  Eigen::Map<Matrix3> operator[](int i) { return Eigen::Map<Matrix3>(current_.data() + std::ptrdiff_t{kStride} * i); }

  /// Replaces each matrix by the mean of its own and its neighbours', `rounds` times. The bits are the same for any
  /// number of threads and on every processor; nothing is allocated. Cost: O(edges) per round.
  void average(const CompressedRows& neighbours, int rounds, ThreadPool& pool);

 private:
  static constexpr int kStride = 12;  // three vectors of four
  std::vector<double> current_, other_;
};

}  // namespace lapedit
