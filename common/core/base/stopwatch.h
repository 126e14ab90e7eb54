// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>

namespace lapedit {

/// Measures time in milliseconds on a clock that never goes back.
class Stopwatch {
  using Clock = std::chrono::steady_clock;

 public:
  /// Returns the time since construction or the last lap().
  double elapsed() const { return std::chrono::duration<double, std::milli>(Clock::now() - last_).count(); }

  /// Returns elapsed() and restarts.
  double lap() {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  Clock::time_point last_ = Clock::now();
};

}  // namespace lapedit
