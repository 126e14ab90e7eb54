// SPDX-License-Identifier: GPL-3.0-or-later
#include "lists/job_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <thread>
#include <utility>
#include <vector>

#include "failure.h"
#include "lapedit/base/thread_pool.h"

namespace {

constexpr int kRequests[] = {SIGINT, SIGTERM, SIGHUP};

double now() {
  struct timespec time = {};
  clock_gettime(CLOCK_REALTIME, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Returns the last line that is not empty.
std::string lastSentence(std::string text) {
  text.erase(text.find_last_not_of(" \r\n") + 1);
  return text.substr(text.find_last_of('\n') + 1);
}

JobEnd endOf(int status, const std::string& text) {
  JobEnd end;
  end.sentence = lastSentence(text);
  if (WIFEXITED(status)) {
    end.code = WEXITSTATUS(status);
    if (end.code != Done && end.sentence.empty()) {
      end.sentence = "It ended with code " + std::to_string(end.code) + " without an error message.";
    }
    return end;
  }
  const int signal = WTERMSIG(status);
  const bool asked = std::find(std::begin(kRequests), std::end(kRequests), signal) != std::end(kRequests);
  end.code = asked ? 128 + signal : static_cast<int>(Unexpected);  // as in a shell
  end.sentence = "It was stopped from outside (signal " + std::to_string(signal) + ", " + strsignal(signal) + ").";
  return end;
}

}  // namespace

int processors() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
    return CPU_COUNT(&allowed);
  }
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

JobPool::JobPool() {
  sigset_t awaited;
  sigemptyset(&awaited);
  for (const int signal : kRequests) {
    sigaddset(&awaited, signal);
  }
  sigaddset(&awaited, SIGCHLD);
  sigprocmask(SIG_BLOCK, &awaited, &before_);
  // Signals that are ignored, as under nohup, do not arrive.
  signals_ = signalfd(-1, &awaited, SFD_CLOEXEC | SFD_NONBLOCK);
  if (signals_ < 0) {
    throw Failure(Unexpected, std::string("Jobs cannot be watched: ") + std::strerror(errno) + ".");
  }
}

JobPool::~JobPool() {
  close(signals_);
  sigprocmask(SIG_SETMASK, &before_, nullptr);
}

bool JobPool::start(int number, int threads, const std::function<int(Notes&)>& work) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    return false;
  }
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    // If this program ends for any reason, its jobs end and clean up.
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    sigprocmask(SIG_SETMASK, &before_, nullptr);
    if (getppid() != parent) {
      _exit(Unexpected);
    }
    dup2(ends[1], STDERR_FILENO);
    for (const auto& [ignored, other] : jobs_) {
      if (other.errors >= 0) {
        close(other.errors);
      }
    }
    close(ends[0]);
    close(ends[1]);
    close(signals_);
    lapedit::limit_threads(threads);
    _exit(supervise(work));
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    return false;
  }
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  jobs_[child] = {number, ends[0], {}, now()};
  return true;
}

void JobPool::readErrors(Running& job) {
  constexpr std::size_t kept = 4096;  // the end is the most useful part
  char part[4096];
  ssize_t count = -1;
  while (job.errors >= 0 && (count = read(job.errors, part, sizeof part)) > 0) {
    job.text.append(part, static_cast<std::size_t>(count));
    if (job.text.size() > kept) {
      job.text.erase(0, job.text.size() - kept);
    }
  }
  if (count == 0) {
    close(std::exchange(job.errors, -1));
  }
}

std::optional<std::pair<int, JobEnd>> JobPool::reap() {
  for (auto job = jobs_.begin(); job != jobs_.end(); ++job) {
    int status = 0;
    struct rusage used = {};
    if (wait4(job->first, &status, WNOHANG, &used) != job->first) {
      continue;
    }
    readErrors(job->second);
    if (job->second.errors >= 0) {  // a child of the job still has it open
      close(job->second.errors);
    }
    JobEnd end = endOf(status, job->second.text);
    end.began = job->second.began;
    end.seconds = now() - end.began;
    end.mostMemory = 1024 * static_cast<qint64>(used.ru_maxrss);
    const int number = job->second.number;
    jobs_.erase(job);
    return std::make_pair(number, std::move(end));
  }
  return {};
}

std::pair<int, JobEnd> JobPool::wait() {
  for (;;) {
    if (auto ended = reap()) {
      return *std::move(ended);
    }
    std::vector<struct pollfd> sources = {{signals_, POLLIN, 0}};
    for (const auto& [ignored, job] : jobs_) {
      sources.push_back({job.errors, POLLIN, 0});  // poll() ignores -1, after its end
    }
    poll(sources.data(), sources.size(), -1);
    for (auto& [ignored, job] : jobs_) {
      readErrors(job);
    }
    struct signalfd_siginfo signal = {};
    while (read(signals_, &signal, sizeof signal) == static_cast<ssize_t>(sizeof signal)) {
      if (signal.ssi_signo != SIGCHLD) {
        stopped_ = static_cast<int>(signal.ssi_signo);
        for (const auto& [process, ignored] : jobs_) {
          kill(process, stopped_);
        }
      }
    }
  }
}
