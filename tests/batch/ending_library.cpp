// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

/// A foreign library that thinks that it may end the program: loaded before others, it does so at the call that
/// LAPEDIT_END_AT names, as in "rename 2".
namespace {

void endAt(const char* function, int call) {
  const char* const given = std::getenv("LAPEDIT_END_AT");
  const std::size_t length = std::strlen(function);
  if (given != nullptr && std::strncmp(given, function, length) == 0 && std::atoi(given + length) == call) {
    std::fputs("What a library says before it ends\nits last words\n", stderr);
    std::exit(1);
  }
}

}  // namespace

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): the system's own are reserved
extern "C" {

[[gnu::visibility("default")]] int fsync(int file) {
  static int calls = 0;
  endAt("fsync", ++calls);
  return static_cast<int>(syscall(SYS_fsync, file));
}

[[gnu::visibility("default")]] int rename(const char* from, const char* to) {
  static int calls = 0;
  endAt("rename", ++calls);
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

[[gnu::visibility("default")]] int unlinkat(int folder, const char* name, int flags) {
  static int calls = 0;
  endAt("unlinkat", ++calls);
  return static_cast<int>(syscall(SYS_unlinkat, folder, name, flags));
}
}
// NOLINTEND(readability-inconsistent-declaration-parameter-name)
