// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "batch_layer_value.h"

/// MeshLab 2022.02's values of parameters, as far as others have them otherwise. Only the program uses them, see
/// batch_plugins.h.
namespace lapedit::host {

using MatrixValue = Matrix44fValue;
using PointValue = Point3fValue;

}  // namespace lapedit::host
