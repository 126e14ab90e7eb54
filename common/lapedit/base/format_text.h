// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "lapedit/base/simd.h"

namespace lapedit {

/// Text like printf's, in the C locale's digits as the host has set them; cut at 1,023 bytes.
LAPEDIT_PRINTF(1, 2) std::string format_text(const char* pattern, ...);

/// A number for a sentence: six significant digits, whatever the host's locale.
std::string number_text(double number);

}  // namespace lapedit
