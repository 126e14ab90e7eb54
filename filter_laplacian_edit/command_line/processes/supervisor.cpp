// SPDX-License-Identifier: GPL-3.0-or-later
#include "processes/supervisor.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>

#include "host/batch_host.h"
#include "processes/error_stream.h"
#include "processes/watchdog.h"

namespace {

constexpr long kLookEvery = 200'000'000;  // nanoseconds

bool comesFromAFault(int signal) {
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS, SIGABRT}) {
    if (signal == fault) {
      return true;
    }
  }
  return false;
}

bool isLeftToTheSystem(int signal) {
  for (const int other : {SIGKILL, SIGSTOP, SIGTSTP, SIGTTIN, SIGTTOU, SIGCONT, SIGURG, SIGWINCH, SIGPIPE}) {
    if (signal == other) {
      return true;
    }
  }
  return comesFromAFault(signal);
}

/// Signals that request the end of the program, and that of the worker's end. They are blocked during the object's
/// lifetime and fetched by it.
class Requests {
 public:
  Requests() {
    // Otherwise the worker's exit code is lost if the parent process ignores the end of its children.
    std::signal(SIGCHLD, SIG_DFL);
    // A missing reader of the reports is a write error and must not kill the program.
    std::signal(SIGPIPE, SIG_IGN);
    sigemptyset(&taken_);
    for (int signal = 1; signal <= SIGRTMAX; ++signal) {
      struct sigaction action = {};
      const bool known = sigaction(signal, nullptr, &action) == 0;
      if (known && !isLeftToTheSystem(signal) && action.sa_handler != SIG_IGN) {  // as under nohup
        sigaddset(&taken_, signal);
      }
    }
    sigprocmask(SIG_BLOCK, &taken_, &before_);
  }
  ~Requests() { restore(); }
  Requests(const Requests&) = delete;
  Requests& operator=(const Requests&) = delete;

  void restore() const { sigprocmask(SIG_SETMASK, &before_, nullptr); }

  /// Returns the next signal, or 0 after a while without one.
  int next() const {
    const struct timespec while_ = {0, kLookEvery};
    const int signal = sigtimedwait(&taken_, nullptr, &while_);
    return signal > 0 ? signal : 0;
  }

 private:
  sigset_t taken_, before_;
};

void raiseAsBefore(int signal) {
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  std::signal(signal, SIG_DFL);
  raise(signal);
  sigprocmask(SIG_UNBLOCK, &only, nullptr);
}

std::string host() {
  return lapedit::host::BatchHost::version().toStdString();
}

/// The notes for the handler of std::terminate().
Notes* ownNotes = nullptr;

}  // namespace

class Supervisor {
 public:
  explicit Supervisor(Notes& notes) : notes_(notes) {}

  int run(const std::function<int(Notes&)>& work) {
    const Requests requests;
    int ends[2] = {-1, -1};  // for the worker's output other than this program's messages
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) {
      return say(Unexpected, std::string("The program cannot start its worker (") + std::strerror(errno) +
                                 "): nothing was written; allow more open files (ulimit -n).");
    }
    const pid_t parent = getpid();
    const pid_t worker = fork();
    if (worker < 0) {
      return say(Unexpected, std::string("The program cannot start its worker (") + std::strerror(errno) +
                                 "): nothing was written; allow more processes (ulimit -u), or end some.");
    }
    if (worker == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      requests.restore();
      if (getppid() != parent) {
        _exit(Unexpected);
      }
      divertStandardError(ends[1]);
      this->work(work);
    }
    close(ends[1]);
    said_from_ = ends[0];
    attend(worker, requests);
    hear();
    close(said_from_);
    return conclude();
  }

 private:
  [[noreturn]] void work(const std::function<int(Notes&)>& work) {
    ownNotes = &notes_;
    std::set_terminate([] {
      ownNotes->lacks(lackIn(std::current_exception()));
      std::abort();
    });
    try {
      notes_.finished(work(notes_));
    } catch (...) {
      notes_.lacks(lackIn(std::current_exception()));
    }
    std::fflush(nullptr);
    // Skips MeshLab's clean-up, which is not needed.
    _exit(notes_.code_);
  }

  void attend(pid_t worker, const Requests& requests) {
    Watchdog watchdog(worker, notes_);
    for (;;) {
      hear();
      struct rusage used = {};
      const pid_t ended = wait4(worker, &status_, WNOHANG, &used);
      processor_seconds_ = static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                           1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
      if (ended == worker || (ended < 0 && errno != EINTR)) {
        return;
      }
      const int signal = requests.next();
      if (signal != 0 && signal != SIGCHLD) {
        request_ = signal;
        kill(worker, signal);
      }
      const Watchdog::Verdict verdict = watchdog.look();
      // Outputs that are being replaced are finished first.
      const Placed placed = notes_.placed_;
      if (verdict != Watchdog::Verdict::GoOn && (placed == Placed::Nothing || placed == Placed::All)) {
        verdict_ = verdict;
        kill(worker, SIGKILL);
      }
    }
  }

  /// Keeps the end of the worker's output.
  void hear() {
    constexpr std::size_t kKept = 4096;
    char part[4096];
    for (ssize_t count = 0; (count = read(said_from_, part, sizeof part)) > 0;) {
      said_.append(part, static_cast<std::size_t>(count));
      said_.erase(0, said_.size() - std::min(said_.size(), kKept));
    }
  }

  /// Returns the end of its last line, for a message; empty without output.
  std::string lastWords() const {
    constexpr std::size_t kLongest = 200;
    std::string text = said_;
    text.erase(text.find_last_not_of(" \r\n") + 1);
    text.erase(0, text.find_last_of('\n') + 1);
    std::replace_if(
        text.begin(), text.end(), [](unsigned char letter) { return letter < ' ' || letter > '~'; }, '?');
    if (text.size() > kLongest) {
      text = "..." + text.substr(text.size() - kLongest);
    }
    return text;
  }

  /// Returns whether a killed worker had used up its processor time.
  bool isOutOfProcessorTime(int signal) const {
    struct rlimit limit = {};
    constexpr double kSpare = 0.5;
    return signal == SIGXCPU ||
           (signal == SIGKILL && getrlimit(RLIMIT_CPU, &limit) == 0 && limit.rlim_max != RLIM_INFINITY &&
            processor_seconds_ + kSpare >= static_cast<double>(limit.rlim_max));
  }

  int conclude() const {
    if (notes_.finished_ && WIFEXITED(status_)) {
      return notes_.code_;
    }
    for (const char* folder : notes_.scratch_) {
      if (folder[0] != '\0') {
        std::error_code ignored;
        std::filesystem::remove_all(folder, ignored);
      }
    }
    if (notes_.placed_ == Placed::All) {
      return Done;
    }
    if (WIFSIGNALED(status_) && WTERMSIG(status_) == request_) {
      raiseAsBefore(request_);
    }
    return notes_.placed_ == Placed::Nothing ? sayWhy() : say(Unwritable, reason() + ": " + state() + ".");
  }

  /// The cases in which nothing was written.
  int sayWhy() const {
    const std::string nothing = ": " + state() + "; ";
    const int signal = WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
    if (verdict_ == Watchdog::Verdict::OutOfTime) {
      return say(Unexpected, reason() + nothing + "allow more with --timeout.");
    }
    if (verdict_ == Watchdog::Verdict::Stalled) {
      return say(notes_.code_,
                 reason() + nothing +
                     "check that the file has the format of its suffix, try another format, or allow more "
                     "(LAPEDIT_STALL_SECONDS).");
    }
    if (isOutOfProcessorTime(signal)) {
      return say(Unexpected, reason() + nothing + "allow more (ulimit -t).");
    }
    if (notes_.lack_ == Lack::Memory || signal == SIGKILL) {
      return say(Unexpected, reason() + nothing + "allow more memory (ulimit -v), or use a smaller mesh.");
    }
    if (notes_.lack_ == Lack::Threads) {
      return say(Unexpected, reason() + nothing + "allow more of them, or more memory (ulimit -u, ulimit -v).");
    }
    if (signal != 0 && !comesFromAFault(signal)) {
      return say(Unexpected, reason() + nothing + "run it again.");
    }
    const int code = notes_.code_;
    return say(code, reason() + ": " + state() +
                         (code == Unexpected ? "." : "; try another file format, such as PLY, OFF or STL."));
  }

  /// Returns the beginning of the message: the cause of the end.
  std::string reason() const {
    const std::string activity = std::string(" while ") + notes_.activity_;
    const int signal = WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
    if (verdict_ == Watchdog::Verdict::OutOfTime) {
      return "The time limit of --timeout was exceeded" + activity;
    }
    if (verdict_ == Watchdog::Verdict::Stalled) {
      return host() + " made no progress for a long time" + activity;
    }
    if (notes_.lack_ == Lack::Memory) {
      return "There was not enough memory" + activity;
    }
    if (notes_.lack_ == Lack::Threads) {
      return "The system allowed no more threads" + activity;
    }
    if (isOutOfProcessorTime(signal)) {
      return "The limit of processor time was exceeded" + activity;
    }
    if (signal == SIGKILL) {
      return "The program was killed" + activity + ", as the system does where memory runs out";
    }
    const std::string last = lastWords();
    const std::string words = last.empty() ? "" : ": " + last;
    if (signal == 0) {
      return host() + " or a library of its own ended the program" + activity + " (exit code " +
             std::to_string(WEXITSTATUS(status_)) + words + ")";
    }
    const std::string number = " (signal " + std::to_string(signal) + ", " + strsignal(signal) + words + ")";
    return comesFromAFault(signal) ? host() + " stopped with an error of its own" + activity + number
                                   : "The program was ended" + activity + number;
  }

  std::string state() const {
    switch (notes_.placed_.load()) {
      case Placed::Nothing:
        return "nothing was written";
      case Placed::Some:
        return "some of the files may have been replaced, each of them completely";
      default:
        return "the outputs are complete, but there is no report";
    }
  }

  static int say(int code, const std::string& sentence) {
    std::fprintf(stderr, "%s\n", sentence.c_str());
    return code;
  }

  Notes& notes_;
  int said_from_ = -1;
  std::string said_;
  double processor_seconds_ = 0;  ///< of the worker
  int status_ = 0;
  int request_ = 0;  ///< the last one that was passed on
  Watchdog::Verdict verdict_ = Watchdog::Verdict::GoOn;
};

int supervise(const std::function<int(Notes&)>& work) {
  void* const shared = mmap(nullptr, sizeof(Notes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) {
    std::fprintf(stderr, "There is not enough memory to start (%s): nothing was written; allow more (ulimit -v).\n",
                 std::strerror(errno));
    return Unexpected;
  }
  const int code = Supervisor(*new (shared) Notes()).run(work);
  munmap(shared, sizeof(Notes));
  return code;
}
