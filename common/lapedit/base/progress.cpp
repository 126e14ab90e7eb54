// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/progress.h"

#include <string>

#include "lapedit/base/error.h"

namespace lapedit {

void report_progress(const Progress& progress, double fraction, const char* stage) {
  if (progress && !progress(fraction, stage)) {
    throw EditError(ErrorCause::Cancelled, std::string("The edit was cancelled while at work on: ") + stage + ".");
  }
}

}  // namespace lapedit
