// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "quality_scene.h"

namespace quality {

/// Returns the pieces between the separators.
inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> pieces;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(separator, from), text.size());
    pieces.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return pieces;
}

/// What is before the first equals sign, and what is behind it.
inline std::pair<std::string, std::string> key_and_value(const std::string& text) {
  const std::size_t at = text.find('=');
  return {text.substr(0, at), at == std::string::npos ? "" : text.substr(at + 1)};
}

/// The default settings with some changed: "key=value,key=value", by the keys of JSON.
/// @throws std::exception naming what is not known or out of range
lapedit::EditSettings settings_of(const std::string& text);

/// This library's. A frame is a preview near the end of a drag.
/// @throws EditError
MethodResult ours(const Problem& scene, const lapedit::EditSettings& settings, int threads);

}  // namespace quality
