// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "quality_scene.h"

namespace quality {

/// Blender's Laplacian Deform modifier with its defaults, on the region alone, in a process of its own: stationary
/// anchors and handles are its anchors. A frame is an update of the modifier after the handles were moved.
/// @throws std::runtime_error if Blender has no result
MethodResult blender(const Scene& scene);

}  // namespace quality
