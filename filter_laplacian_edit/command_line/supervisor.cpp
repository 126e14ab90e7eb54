// SPDX-License-Identifier: GPL-3.0-or-later
#include "supervisor.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>

#include "batch_host.h"

namespace {

constexpr int kRequests[] = {SIGINT, SIGTERM, SIGHUP};

volatile sig_atomic_t worker = 0;

void passOn(int signal) {
  if (worker > 0) {
    kill(worker, signal);
  }
}

void copy(const std::string& text, char* to, std::size_t size) {
  std::snprintf(to, size, "%s", text.c_str());
}

void handleRequests(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  for (const int signal : kRequests) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) {  // as under nohup
      sigaction(signal, &action, nullptr);
    }
  }
}

}  // namespace

void Notes::doing(const std::string& activity, ExitCode code) {
  copy(activity, activity_, sizeof activity_);
  code_ = code;
}

void Notes::scratch(const std::string& folder) {
  copy(folder, scratch_, sizeof scratch_);
}

int supervise(const std::function<int(Notes&)>& work) {
  void* const shared = mmap(nullptr, sizeof(Notes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) {
    std::perror("laplacian-edit: mmap");
    return Unexpected;
  }
  auto* const notes = new (shared) Notes();
  notes->doing("starting", Unexpected);
  // Whoever is asked to stop before there is somebody to pass it on to stops by itself.
  sigset_t requests, before;
  sigemptyset(&requests);
  for (const int signal : kRequests) {
    sigaddset(&requests, signal);
  }
  sigprocmask(SIG_BLOCK, &requests, &before);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) {
    std::perror("laplacian-edit: fork");
    return Unexpected;
  }
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    if (getppid() != parent) {
      _exit(Unexpected);
    }
    const int code = work(*notes);
    std::fflush(nullptr);
    // Not through the host's own clean-up, which nobody needs.
    _exit(code);
  }
  worker = child;
  handleRequests(passOn);
  sigprocmask(SIG_SETMASK, &before, nullptr);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  worker = 0;
  if (WIFEXITED(status)) {
    return WEXITSTATUS(status);
  }
  if (notes->scratch_[0] != '\0') {
    std::error_code ignored;
    std::filesystem::remove_all(notes->scratch_, ignored);
  }
  const int signal = WTERMSIG(status);
  for (const int request : kRequests) {
    if (signal == request) {
      handleRequests(SIG_DFL);
      raise(signal);
    }
  }
  std::fprintf(stderr, "%s stopped with an error of its own while %s (signal %d, %s): nothing was written%s.\n",
               lapedit::host::BatchHost::version().toUtf8().constData(), notes->activity_, signal, strsignal(signal),
               notes->code_ == Unexpected ? "" : "; try another file format, such as PLY, OFF or STL");
  return notes->code_;
}
