// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "quality_scene.h"

namespace quality {

/// The default settings with some changed: "key=value,key=value", by the keys of JSON.
/// @throws std::exception naming what is not known or out of range
lapedit::EditSettings settings_of(const std::string& text);

/// This library's. A frame is a preview near the end of a drag.
/// @throws EditError
MethodResult ours(const Scene& scene, const lapedit::EditSettings& settings, int threads);

/// Returns a function that solves for a fraction of the edit's motions, 0 to 1, and returns the positions of the whole
/// mesh. It uses the scene, which has to live as long.
std::function<lapedit::Points(double)> poser(const Scene& scene, const lapedit::EditSettings& settings);

}  // namespace quality
