// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/session/drag_settings.h"

namespace lapedit {

/// Settings for a kind of surface. Only their values are recorded.
struct Preset {
  const char* name;  ///< what the user sees
  const char* help;  ///< one sentence
  void (*set)(DragSettings&);
};

/// Returns the presets; the first one has the initial settings.
const std::vector<Preset>& presets();

/// Returns the preset with the values of the settings, -1 if none. Sizes and machine settings are ignored.
int preset_of(const DragSettings& settings);

}  // namespace lapedit
