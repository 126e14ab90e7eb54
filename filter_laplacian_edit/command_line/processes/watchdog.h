// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>

#include "processes/notes.h"

/// Sees when a worker has used up its time, or when the host's reading or writing gets nowhere. As getting on counts
/// what the host says of its progress, and each byte that is read or written. Time is the processor's, so that a
/// machine with much else to do is no reason to end anything; ten times as long without any work counts as well.
class Watchdog {
 public:
  enum class Verdict { GoOn, OutOfTime, Stalled };

  Watchdog(pid_t worker, const Notes& notes);

  /// To be called some times a second.
  Verdict look();

  /// How long nothing may happen with files of so many bytes, seconds: two minutes (LAPEDIT_STALL_SECONDS in the
  /// environment says otherwise), and one more for each megabyte.
  static double patience(std::int64_t bytes);

 private:
  /// What changes while the work gets on.
  struct Signs {
    int activities = 0, percent = 0;
    std::int64_t moved = 0;  // bytes
    bool operator!=(const Signs& other) const {
      return activities != other.activities || percent != other.percent || moved != other.moved;
    }
  };
  using Clock = std::chrono::steady_clock;

  Signs signs() const;
  double processorTime() const;

  pid_t worker_;
  const Notes& notes_;
  Clock::time_point start_, last_;
  Signs seen_;
  double used_ = 0;    // of the processor when there was a sign last, seconds
  double waited_ = 0;  // since then, seconds
};
