// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "lapedit/base/compiler.h"

namespace lapedit {

/// Returns text formatted as by printf, with the decimal point of the process's locale.
LAPEDIT_PRINTF(1, 2) std::string format_text(const char* pattern, ...);

/// Returns a number for messages: six significant digits, independent of the locale.
std::string number_text(double number);

}  // namespace lapedit
