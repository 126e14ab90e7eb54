// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/format_text.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <locale>
#include <sstream>

namespace lapedit {

std::string format_text(const char* pattern, ...) {
  va_list arguments, again;
  va_start(arguments, pattern);
  va_copy(again, arguments);
  // The whole text, since a cut might be inside a letter of UTF-8.
  std::string text(static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, pattern, arguments))), '\0');
  std::vsnprintf(text.data(), text.size() + 1, pattern, again);
  va_end(again);
  va_end(arguments);
  return text;
}

std::string number_text(double number) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << number;
  return out.str();
}

}  // namespace lapedit
