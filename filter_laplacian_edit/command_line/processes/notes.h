// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <string>

#include "failure.h"

/// What of the output and the report is in its place.
enum class Placed { Nothing, Some, Outputs, All };

/// What cannot be had from the system.
enum class Lack { Nothing, Memory, Threads };

/// Whether that is what an exception is about.
Lack lackIn(const std::exception_ptr& problem);

/// What the worker lets its supervisor know. Written by one process, read by another, even after the first has died.
/// Texts are to be read only then.
class Notes {
 public:
  static constexpr int kScratchFolders = 2;

  /// @param activity  as in "reading mesh.ply"
  /// @param code      what the program ends with if this stops it
  /// @param bytes     about how many the host reads or writes now: it has to get on with them. Negative: no such work
  void doing(const std::string& activity, ExitCode code, std::int64_t bytes = -1);
  /// How far that has come, 0 to 1.
  void progress(double fraction) { percent_ = static_cast<int>(100 * fraction); }
  /// A folder that has to be gone in the end.
  /// @param k  which, below kScratchFolders
  void scratch(int k, const std::string& folder);
  void placed(Placed what) { placed_ = what; }
  void lacks(Lack what) { lack_ = what; }
  /// For the whole work, since the start of the program.
  void timeLimit(double seconds) { time_limit_ = seconds; }
  /// The worker ended as it should, with a sentence if there is one to be said. Who ends without this was ended.
  void finished(int code);

 private:
  friend class Supervisor;
  friend class Watchdog;

  char activity_[1024] = "starting";
  char scratch_[kScratchFolders][4096] = {};
  std::atomic<int> code_{Unexpected}, percent_{0}, activities_{0};
  std::atomic<std::int64_t> bytes_{-1};
  std::atomic<double> time_limit_{0};  // none
  std::atomic<Placed> placed_{Placed::Nothing};
  std::atomic<Lack> lack_{Lack::Nothing};
  std::atomic<bool> finished_{false};
};
