// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/supernode_kernels_of_file.h"

namespace lapedit::supernode {

template <typename Scalar>
Kernels<Scalar> same_bits_kernels() {
  return chosen_kernels<Scalar>();
}

template Kernels<float> same_bits_kernels();
template Kernels<double> same_bits_kernels();

}  // namespace lapedit::supernode
