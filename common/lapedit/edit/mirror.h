// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A plane that edits are mirrored at; model units.
struct MirrorPlane {
  Vector3 point = Vector3::Zero();
  Vector3 normal = Vector3::UnitX();  ///< any length but zero
};

}  // namespace lapedit
