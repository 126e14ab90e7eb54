// SPDX-License-Identifier: GPL-3.0-or-later
//
// Leaks, so that a test sees LeakSanitizer at work: where it may not look at a process it says nothing of others
// either.
#include <cstdlib>

int main() {
  static volatile char* leak = nullptr;
  leak = static_cast<char*>(std::malloc(77));
  leak[0] = 1;
  leak = nullptr;
  return 0;
}
