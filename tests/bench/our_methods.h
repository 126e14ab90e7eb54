// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "lapedit/deform/edit_settings.h"
#include "quality_scene.h"

namespace quality {

/// The default settings with some changed: "key=value,key=value", by the keys of JSON.
/// @throws std::exception naming what is not known or out of range
lapedit::EditSettings settings_of(const std::string& text);

/// This library's. A frame is a preview near the end of a drag.
/// @throws EditError
MethodResult ours(const Scene& scene, const lapedit::EditSettings& settings);

}  // namespace quality
