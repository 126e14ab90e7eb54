// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>

#include "processes/notes.h"

/// Detects a worker that has exceeded its time, or whose reading or writing makes no progress. Progress is what MeshLab
/// reports, and each byte that is read or written. Processor time counts, so that a busy machine ends nothing; ten
/// times as long without any work counts as well.
class Watchdog {
 public:
  enum class Verdict { GoOn, OutOfTime, Stalled };

  Watchdog(pid_t worker, const Notes& notes);

  /// To be called several times a second.
  Verdict look();

  /// Returns the longest time without progress for a file of this size, in seconds: two minutes (LAPEDIT_STALL_SECONDS
  /// in the environment overrides it), and one second for each megabyte.
  static double patience(std::int64_t bytes);

 private:
  /// Signs of progress.
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
  double used_ = 0;    // processor time at the last sign, seconds
  double waited_ = 0;  // since then, seconds
};
