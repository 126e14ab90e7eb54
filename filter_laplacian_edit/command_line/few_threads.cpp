// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstring>
#include <vector>

#include "failure.h"

/// OpenBLAS starts a thread per processor while it is loaded, before main(), each with memory of its own. Where the
/// system does not allow that, it spins for ever, or ends the program by SIGINT. So where limits are low, the program
/// starts itself again with one thread, and says so where there is not even room for that.
namespace {

constexpr std::size_t kRoomOfOne = std::size_t{192} << 20;
constexpr char kNoRoom[] =
    "There is not enough memory to begin: nothing was written; give it more memory (ulimit -v, ulimit -d).\n";

bool isBelow(int resource, rlim_t enough) {
  struct rlimit limit = {};
  return getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) == 0 && limit.rlim_cur < enough;
}

bool hasRoom(std::size_t bytes) {
  void* const room = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return room != MAP_FAILED && munmap(room, bytes) == 0;
}

void takeFewThreads(int, char** arguments, char** environment) {
  const auto processors = static_cast<rlim_t>(sysconf(_SC_NPROCESSORS_ONLN));
  const rlim_t memory = (rlim_t{1} << 30) + processors * (rlim_t{256} << 20);
  if (!isBelow(RLIMIT_AS, memory) && !isBelow(RLIMIT_DATA, memory) && !isBelow(RLIMIT_NPROC, 1024)) {
    return;
  }
  if (!hasRoom(kRoomOfOne)) {
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kNoRoom, std::strlen(kNoRoom));
    _exit(Unexpected);
  }
  char variable[] = "OPENBLAS_NUM_THREADS=1";
  std::vector<char*> variables = {variable};
  for (char** other = environment; *other != nullptr; ++other) {
    if (std::strncmp(*other, variable, std::strlen("OPENBLAS_NUM_THREADS=")) == 0) {
      return;  // it is said already, by the user or here
    }
    variables.push_back(*other);
  }
  variables.push_back(nullptr);
  execve("/proc/self/exe", arguments, variables.data());
}

// Before the libraries' own beginnings, which those of a program follow.
[[gnu::section(".preinit_array"), gnu::used]] void (*const kBeforeLibraries)(int, char**, char**) = takeFewThreads;

}  // namespace
