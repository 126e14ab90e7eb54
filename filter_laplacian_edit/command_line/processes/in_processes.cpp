// SPDX-License-Identifier: GPL-3.0-or-later
#include "processes/in_processes.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "failure.h"
#include "lapedit/base/thread_pool.h"

namespace {

constexpr int kNoMemory = 100;  // not one of the program's codes

/// Does the work of one process. @return its exit code
int codeOf(const std::function<void(int)>& work, int number, int sentences) {
  std::string sentence;
  int code = Done;
  try {
    work(number);
  } catch (const Failure& failure) {
    sentence = failure.what();
    code = failure.code();
  } catch (const std::bad_alloc&) {
    code = kNoMemory;
  } catch (const std::exception& error) {
    sentence = error.what();
    code = Unexpected;
  }
  // Short enough to be written atomically.
  sentence.resize(std::min<std::size_t>(sentence.size(), 2000));
  return ::write(sentences, sentence.data(), sentence.size()) >= 0 ? code : static_cast<int>(Unexpected);
}

pid_t start(const std::function<void(int)>& work, int number, int threads, int sentences) {
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) {
      _exit(Unexpected);
    }
    lapedit::limit_threads(threads);
    _exit(codeOf(work, number, sentences));
  }
  return child;
}

void stop(const std::vector<pid_t>& processes) {
  for (const pid_t process : processes) {
    kill(process, SIGKILL);
  }
  for (const pid_t process : processes) {
    waitpid(process, nullptr, 0);
  }
}

[[noreturn]] void fail(int status, int sentences) {
  if (WIFSIGNALED(status)) {
    std::signal(WTERMSIG(status), SIG_DFL);
    raise(WTERMSIG(status));
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : static_cast<int>(Unexpected);
  if (code == kNoMemory) {
    throw std::bad_alloc();
  }
  char sentence[2001] = {};
  const bool told = ::read(sentences, sentence, sizeof sentence - 1) > 0;
  throw Failure(static_cast<ExitCode>(code),
                told ? sentence : "A process that wrote files ended without an error message.");
}

}  // namespace

void inProcesses(int count, const std::function<void(int)>& work) {
  if (count <= 1) {
    work(0);
    return;
  }
  int ends[2];
  if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) {
    throw Failure(Unexpected, std::string("A pipe cannot be created (") + std::strerror(errno) +
                                  "): allow more open files (ulimit -n).");
  }
  std::fflush(nullptr);
  std::vector<pid_t> running;
  const int threads = std::max(1, lapedit::thread_count(0) / count);
  for (int k = 0; k < count; ++k) {
    const pid_t child = start(work, k, threads, ends[1]);
    if (child < 0) {
      const std::string why = std::strerror(errno);
      stop(running);
      throw Failure(Unexpected, "A process to write files cannot be started (" + why + "): use fewer --jobs.");
    }
    running.push_back(child);
  }
  while (!running.empty()) {
    int status = 0;
    const pid_t ended = waitpid(-1, &status, 0);
    const auto found = std::find(running.begin(), running.end(), ended);
    if (found == running.end()) {
      continue;
    }
    running.erase(found);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != Done) {
      stop(running);
      fail(status, ends[0]);
    }
  }
  close(ends[0]);
  close(ends[1]);
}
