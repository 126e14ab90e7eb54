// SPDX-License-Identifier: GPL-3.0-or-later
#include "progress_line.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "processes/error_stream.h"

namespace {

bool isTerminal() {
  const char* const kind = std::getenv("TERM");
  return isatty(fileno(errorStream())) != 0 && kind != nullptr && std::strcmp(kind, "dumb") != 0;
}

}  // namespace

ProgressLine::ProgressLine(bool wanted) : wanted_(wanted && isTerminal()) {}

ProgressLine::~ProgressLine() {
  clear();
}

void ProgressLine::show(double fraction, const char* stage) {
  if (wanted_) {
    const int percent = static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0));
    std::fprintf(errorStream(), "\r\033[K%3d %% %.60s", percent, stage);
    shown_ = true;
  }
}

void ProgressLine::clear() {
  if (shown_) {
    std::fputs("\r\033[K", errorStream());
    shown_ = false;
  }
}
