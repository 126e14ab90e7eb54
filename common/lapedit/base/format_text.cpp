// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/format_text.h"

#include <cstdarg>
#include <cstdio>
#include <locale>
#include <sstream>

namespace lapedit {

std::string format_text(const char* pattern, ...) {
  char text[1024];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
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
