// SPDX-License-Identifier: GPL-3.0-or-later
#include "processes/watchdog.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

namespace {

double seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

Watchdog::Watchdog(pid_t worker, const Notes& notes)
    : worker_(worker), notes_(notes), start_(Clock::now()), last_(start_) {}

double Watchdog::patience(std::int64_t bytes) {
  const char* const given = std::getenv("LAPEDIT_STALL_SECONDS");
  return (given != nullptr ? std::atof(given) : 120.0) + static_cast<double>(bytes) / 1e6;
}

Watchdog::Signs Watchdog::signs() const {
  Signs now;
  now.activities = notes_.activities_;
  now.percent = notes_.percent_;
  std::ifstream file("/proc/" + std::to_string(worker_) + "/io");
  std::string name;
  for (std::int64_t bytes = 0; file >> name >> bytes;) {
    now.moved += name == "rchar:" || name == "wchar:" ? bytes : 0;
  }
  return now;
}

double Watchdog::processorTime() const {
  clockid_t clock = 0;
  struct timespec time = {};
  if (clock_getcpuclockid(worker_, &clock) != 0 || clock_gettime(clock, &time) != 0) {
    return 0;
  }
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Watchdog::Verdict Watchdog::look() {
  const Clock::time_point now = Clock::now();
  const double limit = notes_.time_limit_;
  if (limit > 0 && seconds(now - start_) > limit) {
    return Verdict::OutOfTime;
  }
  // A process that was stopped for a while made no checks either.
  waited_ += std::min(seconds(now - last_), 1.0);
  last_ = now;
  const std::int64_t bytes = notes_.bytes_;
  const Signs signsNow = signs();
  const double used = processorTime();
  if (bytes < 0 || signsNow != seen_) {
    seen_ = signsNow;
    used_ = used;
    waited_ = 0;
    return Verdict::GoOn;
  }
  const double most = patience(bytes);
  return used - used_ > most || waited_ > 10 * most ? Verdict::Stalled : Verdict::GoOn;
}
