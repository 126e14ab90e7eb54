// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace lapedit {

/// Called during long work, on the thread that asked for the work, with the fraction done, 0 to 1, and the name of the
/// stage. Called about every millisecond, mostly with the same values. If it returns false or throws, the work stops
/// with EditError (Cancelled). May be empty.
using Progress = std::function<bool(double fraction, const char* stage)>;

/// As long as it lives, the work of this thread, and that of thread pools for this thread, reports to a progress
/// function and stops when the function says so. Work without a scope cannot be cancelled.
class ProgressScope {
 public:
  /// @param progress  must outlive the object. If it is empty, an outer scope stays in charge
  explicit ProgressScope(const Progress& progress);
  explicit ProgressScope(Progress&&) = delete;
  ~ProgressScope();
  ProgressScope(const ProgressScope&) = delete;
  ProgressScope& operator=(const ProgressScope&) = delete;

  /// Returns the scope of this thread; null if there is none.
  static ProgressScope* current();
  /// Lets this thread work for the scope of another thread, or for none.
  static void work_for(ProgressScope* scope);

 private:
  friend class ProgressPart;
  friend void report_progress(double fraction, const char* stage);
  friend void checkpoint(int work);
  bool is_own_thread() const { return std::this_thread::get_id() == thread_; }
  void call();

  const Progress& progress_;
  ProgressScope* const outer_;
  const std::thread::id thread_ = std::this_thread::get_id();
  std::atomic<bool> cancelled_{false};
  int left_;                       // units of work until the next call
  std::string shown_;              // the stage of the last call
  std::mutex mutex_;               // of what follows
  double begin_ = 0, length_ = 1;  // of the current part
  double fraction_ = 0;
  std::string stage_ = "mesh";
};

/// As long as it lives, fractions of this thread's scope are those of the k-th of `count` equal parts, of the part
/// around it if there is one.
class ProgressPart {
 public:
  ProgressPart(std::size_t k, std::size_t count);
  ~ProgressPart();
  ProgressPart(const ProgressPart&) = delete;
  ProgressPart& operator=(const ProgressPart&) = delete;

 private:
  double begin_ = 0, length_ = 1;  // of the part around
};

/// Begins a stage of the work. A fraction below an earlier one counts as that. @throws EditError (Cancelled)
void report_progress(double fraction, const char* stage);

/// A unit of work takes 0.01 to 1 microseconds, such as a visit of a vertex and its neighbours.
constexpr int kWorkPerCall = 4096;

/// Calls the progress function once per kWorkPerCall units of work. On threads other than the scope's it only sees
/// whether the work was cancelled. Costs some nanoseconds. @param work  units since the last checkpoint
/// @throws EditError (Cancelled)
void checkpoint(int work = kWorkPerCall);

/// Counts the work of a loop whose passes take less time than a checkpoint.
class Checkpoints {
 public:
  /// @throws EditError (Cancelled)
  void operator()(int work = 1) {
    if ((counted_ += work) >= kEnough) {
      checkpoint(counted_);
      counted_ = 0;
    }
  }

 private:
  static constexpr int kEnough = 1024;
  int counted_ = 0;
};

}  // namespace lapedit
