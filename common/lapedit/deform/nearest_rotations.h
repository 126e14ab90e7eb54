// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/base/types.h"

namespace lapedit {

/// rotations[i] = nearest_rotation(matrices[i]), bit for bit, several at a time where the processor can. They may be
/// the same.
void nearest_rotations(const Matrix3* matrices, int count, Matrix3* rotations);

}  // namespace lapedit
