// SPDX-License-Identifier: GPL-3.0-or-later
#include "processes/error_stream.h"

#include <fcntl.h>
#include <unistd.h>

namespace {

std::FILE* ours = nullptr;

}  // namespace

std::FILE* errorStream() {
  return ours != nullptr ? ours : stderr;
}

void divertStandardError(int other) {
  const int own = ::fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 3);
  std::FILE* const file = own >= 0 ? ::fdopen(own, "w") : nullptr;
  if (file != nullptr && ::dup2(other, STDERR_FILENO) >= 0) {
    std::setvbuf(file, nullptr, _IONBF, 0);
    ours = file;
  }
}
