// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/session/drag_settings.h"

namespace lapedit {

/// Settings that suit a kind of surface, set at once. Nothing but their values is recorded.
struct Preset {
  const char* name;  ///< what the user sees
  const char* help;  ///< one sentence
  void (*set)(DragSettings&);
};

/// The first are the settings that a session begins with.
const std::vector<Preset>& presets();

/// The preset whose values the settings have, -1 if none. Sizes and what belongs to the machine do not count.
int preset_of(const DragSettings& settings);

}  // namespace lapedit
