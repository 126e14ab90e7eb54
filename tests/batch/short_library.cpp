// SPDX-License-Identifier: GPL-3.0-or-later
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <climits>
#include <cstdio>
#include <string>

/// A disk that loses what it was told to write, without a word: of PLY files the last byte, when they are closed.
extern "C" [[gnu::visibility("default")]] int fclose(FILE* stream) {
  const int number = fileno(stream);
  const std::string link = "/proc/self/fd/" + std::to_string(number);
  char path[PATH_MAX] = {};
  const bool is_ply = readlink(link.c_str(), path, sizeof path - 1) > 4 &&
                      std::string(path).rfind(".ply") == std::string(path).size() - 4;
  if (is_ply && (fcntl(number, F_GETFL) & O_ACCMODE) != O_RDONLY) {
    fflush(stream);
    const off_t size = lseek(number, 0, SEEK_END);
    static_cast<void>(ftruncate(number, size - 1) == 0);
  }
  static const auto real = reinterpret_cast<int (*)(FILE*)>(dlsym(RTLD_NEXT, "fclose"));
  return real(stream);
}
