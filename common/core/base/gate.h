// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>

#include "lapedit/base/compiler.h"

namespace lapedit {

/// Lets threads wait for each other: they spin for a moment, then sleep. They do not yield, which would give a whole
/// time slice to another process although the awaited work takes microseconds.
class Gate {
 public:
  using Clock = std::chrono::steady_clock;

  /// Returns when ready() is true; ready() reads atomics and is called often.
  /// @param limit  0: none; otherwise it returns about after this time in any case
  template <class Ready>
  void wait(const Ready& ready, Clock::duration limit = {}) {
    // About the cost of waking a sleeping thread.
    constexpr std::chrono::microseconds kPatience{50};
    constexpr int kLooks = 32;
    const Clock::time_point start = Clock::now();
    Clock::time_point now = start;
    do {
      for (int look = 0; look < kLooks; ++look) {
        if (ready()) {
          return;
        }
        pause_processor();
      }
      now = Clock::now();
    } while (now - start < kPatience);
    std::unique_lock<std::mutex> lock(mutex_);
    ++asleep_;  // Before ready() is called, so that open() in another thread sees it: prevents a lost wake-up.
    if (limit > Clock::duration()) {
      wake_.wait_for(lock, limit, ready);
    } else {
      wake_.wait(lock, ready);
    }
    --asleep_;
  }

  /// Wakes sleeping threads. Callers call it after each change that may make a thread ready. Costs one atomic read
  /// while no thread sleeps.
  void open() {
    if (asleep_.load() > 0) {
      { const std::lock_guard<std::mutex> lock(mutex_); }
      wake_.notify_all();
    }
  }

 private:
  std::atomic<int> asleep_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
};

}  // namespace lapedit
