// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/frontal_kernels_of_file.h"

namespace lapedit::supernode {

FrontalKernel best_frontal_kernel() {
  return chosen_frontal_kernel();
}

}  // namespace lapedit::supernode
