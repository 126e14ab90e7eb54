// SPDX-License-Identifier: GPL-3.0-or-later
/// The command: checks the system's limits and executes the program. It links the C library alone: where little memory
/// is allowed, the loader cannot load MeshLab's libraries and would end the program with a message of its own.
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "failure.h"

namespace {

constexpr std::size_t kRoomForLibraries = std::size_t{128} << 20;  // address space
constexpr std::size_t kRoomToBegin = std::size_t{192} << 20;       // memory
constexpr char kProgram[] = "../libexec/laplacian-edit";           // from the command's folder

bool isBelow(int resource, rlim_t enough) {
  struct rlimit limit = {};
  return getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) == 0 && limit.rlim_cur < enough;
}

/// The room is given back by execv().
bool hasRoom() {
  void* const room = mmap(nullptr, kRoomForLibraries + kRoomToBegin, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return room != MAP_FAILED && mprotect(room, kRoomToBegin, PROT_READ | PROT_WRITE) == 0;
}

/// Some of MeshLab's plugins load OpenBLAS, which starts a thread per processor, each with its own memory. If the
/// system does not allow that, it spins for ever or ends the program by SIGINT. With low limits it therefore gets one
/// thread.
/// @return false if the program cannot start even so
bool fitToLimits() {
  const auto processors = static_cast<rlim_t>(sysconf(_SC_NPROCESSORS_ONLN));
  const rlim_t memory = (rlim_t{1} << 30) + processors * (rlim_t{256} << 20);
  if (!isBelow(RLIMIT_AS, memory) && !isBelow(RLIMIT_DATA, memory) && !isBelow(RLIMIT_NPROC, 1024)) {
    return true;
  }
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
  return hasRoom();
}

}  // namespace

int main(int, char** argv) {
  if (!fitToLimits()) {
    std::fputs("There is not enough memory to start: nothing was written; allow more (ulimit -v, ulimit -d).\n",
               stderr);
    return Unexpected;
  }
  char path[PATH_MAX + sizeof kProgram];
  const ssize_t length = readlink("/proc/self/exe", path, PATH_MAX);
  if (length > 0) {
    path[length] = '\0';
    std::strcpy(std::strrchr(path, '/') + 1, kProgram);
    execv(path, argv);
  }
  std::fprintf(stderr, "The program %s cannot be started (%s): nothing was written; install laplacian-edit again.\n",
               length > 0 ? path : kProgram, std::strerror(errno));
  return Unexpected;
}
