// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <string>

#include "failure.h"

/// Which of outputs and report have replaced their targets.
enum class Placed { Nothing, Some, Outputs, All };

/// A resource that the system refuses.
enum class Lack { Nothing, Memory, Threads };

/// Returns the resource that an exception is about.
Lack lackIn(const std::exception_ptr& problem);

/// Messages from the worker to its supervisor. One process writes, the other reads, even after the first has died;
/// texts only then.
class Notes {
 public:
  static constexpr int kScratchFolders = 2;

  /// @param activity  as in "reading mesh.ply"
  /// @param code      exit code if the worker stops in this activity
  /// @param bytes     approximate size of the file that MeshLab reads or writes, which requires progress; negative:
  /// none
  void doing(const std::string& activity, ExitCode code, std::int64_t bytes = -1);
  /// Progress of the activity, 0 to 1.
  void progress(double fraction) { percent_ = static_cast<int>(100 * fraction); }
  /// A folder that has to be removed in the end.
  /// @param k  index, below kScratchFolders
  void scratch(int k, const std::string& folder);
  void placed(Placed what) { placed_ = what; }
  void lacks(Lack what) { lack_ = what; }
  /// Time limit of the whole work, from the start of the program.
  void timeLimit(double seconds) { time_limit_ = seconds; }
  /// Notes a regular end, with an error message if there is one. A worker that ends without this call was ended.
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
