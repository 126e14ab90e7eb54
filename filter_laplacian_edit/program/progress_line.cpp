// SPDX-License-Identifier: GPL-3.0-or-later
#include "progress_line.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "files/system.h"

namespace {

bool isCapableTerminal() {
  const char* const kind = std::getenv("TERM");
  return lapedit::system::isTerminal(stderr) && kind != nullptr && kind != std::string("dumb");
}

}  // namespace

ProgressLine::ProgressLine(bool wanted) : wanted_(wanted && isCapableTerminal()) {}

void ProgressLine::show(double fraction, const char* stage) {
  if (wanted_) {
    std::fprintf(stderr, "\r\033[K%3d %% %.60s", static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0)), stage);
    shown_ = true;
  }
}

void ProgressLine::clear() {
  if (shown_) {
    std::fputs("\r\033[K", stderr);
    shown_ = false;
  }
}
