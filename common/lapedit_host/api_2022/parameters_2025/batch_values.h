// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "batch_layer_value.h"

/// MeshLab 2025.07's values of parameters, as far as others have them otherwise. Only the program uses them, see
/// batch_plugins.h.
namespace lapedit::host {

using MatrixValue = Matrix44Value;
using PointValue = Point3Value;

}  // namespace lapedit::host
