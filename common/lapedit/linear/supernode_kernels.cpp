// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/supernode_kernels_of_file.h"

namespace lapedit::supernode {

template <typename Scalar>
Kernels<Scalar> best_kernels() {
  return chosen_kernels<Scalar>();
}

template Kernels<float> best_kernels();
template Kernels<double> best_kernels();

std::size_t tiles_of(int columns, int rows) {
  std::size_t size = 0;
  for (int first = 0; first < columns; first += kWide) {
    const int width = std::min(kWide, columns - first);
    size += block_size(width, rows - first - width);
  }
  return size;
}

}  // namespace lapedit::supernode
