// SPDX-License-Identifier: GPL-3.0-or-later
#include "processes/system_limits.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "failure.h"

/// Some of MeshLab's plugins load OpenBLAS, which starts a thread per processor, each with its own memory. If the
/// system does not allow that, it spins for ever or ends the program by SIGINT. With low limits it therefore gets one
/// thread, and if memory does not suffice for that, the program reports it.
namespace {

constexpr std::size_t kRoomToBegin = std::size_t{192} << 20;
constexpr char kNoRoom[] =
    "There is not enough memory to start: nothing was written; allow more (ulimit -v, ulimit -d).\n";

bool isBelow(int resource, rlim_t enough) {
  struct rlimit limit = {};
  return getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) == 0 && limit.rlim_cur < enough;
}

bool hasRoom(std::size_t bytes) {
  void* const room = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return room != MAP_FAILED && munmap(room, bytes) == 0;
}

}  // namespace

void fitToLimits() {
  const auto processors = static_cast<rlim_t>(sysconf(_SC_NPROCESSORS_ONLN));
  const rlim_t memory = (rlim_t{1} << 30) + processors * (rlim_t{256} << 20);
  if (!isBelow(RLIMIT_AS, memory) && !isBelow(RLIMIT_DATA, memory) && !isBelow(RLIMIT_NPROC, 1024)) {
    return;
  }
  if (!hasRoom(kRoomToBegin)) {
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kNoRoom, std::strlen(kNoRoom));
    _exit(Unexpected);
  }
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
}
