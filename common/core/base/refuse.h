// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <type_traits>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"

namespace lapedit {

/// The key and the vertex of an EditError.
struct Refused {
  std::string key = {};
  int vertex = -1;
};

/// @param parts  of the message: texts, and numbers, which are written as number_text() and std::to_string() do
/// @throws EditError
template <class... Parts>
[[noreturn]] void refuse_edit(ErrorCause cause, const Refused& at, const Parts&... parts) {
  std::string sentence;
  const auto add = [&sentence](const auto& part) {
    using Part = std::decay_t<decltype(part)>;
    if constexpr (std::is_floating_point_v<Part>) {
      sentence += number_text(part);
    } else if constexpr (std::is_integral_v<Part>) {
      sentence += std::to_string(part);
    } else {
      sentence += part;
    }
  };
  (add(parts), ...);
  EditError refusal(cause, sentence, at.vertex);
  throw at.key.empty() ? refusal : refusal.at(at.key);
}

}  // namespace lapedit
