// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/resource.h>
#include <unistd.h>

#include <cstring>
#include <vector>

/// OpenBLAS starts a thread per processor while it is loaded, before main(). Where the system does not allow them it
/// spins for ever, or ends the program by SIGINT. Where limits are low, the program starts itself again with one.
namespace {

bool isBelow(int resource, rlim_t enough) {
  struct rlimit limit = {};
  return getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) == 0 && limit.rlim_cur < enough;
}

void takeFewThreads(int, char** arguments, char** environment) {
  const auto processors = static_cast<rlim_t>(sysconf(_SC_NPROCESSORS_ONLN));
  const rlim_t memory = (rlim_t{1} << 30) + processors * (rlim_t{256} << 20);
  if (!isBelow(RLIMIT_AS, memory) && !isBelow(RLIMIT_DATA, memory) && !isBelow(RLIMIT_NPROC, 1024)) {
    return;
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
