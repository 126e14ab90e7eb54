// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "lapedit/base/joined_thread.h"

namespace lapedit {

/// Computes answers on a thread that ends when there is no more work. The newest work wins: it replaces work that has
/// not begun, and the answer of work in progress is discarded. Errors are delivered in place of the answer.
///
/// Call all functions from one thread. None of them waits, except wait() and the destructor, which wait for work in
/// progress.
template <class Answer>
class BackgroundTask {
 public:
  using Work = std::function<Answer()>;

  /// @param wake  called when take() has an answer or an error, usually from the other thread
  explicit BackgroundTask(std::function<void()> wake) : wake_(std::move(wake)) {}
  ~BackgroundTask() { replace(nullptr); }
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;

  void start(Work work) {
    if (replace(std::move(work))) {
      return;  // the running thread takes it
    }
    try {
      thread_ = JoinedThread([this] { run(); });
    } catch (const std::system_error&) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        is_running_ = false;
        next_ = nullptr;
        error_ = std::make_exception_ptr(std::runtime_error(
            "The system allows no more threads: end some programs, or raise the limit (ulimit -u)."));
      }
      wake_();
    }
  }
  void cancel() { replace(nullptr); }

  /// Returns the answer of the newest work, `std::nullopt` until it is there. @throws the work's exception, once
  std::optional<Answer> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error_) {
      std::rethrow_exception(std::exchange(error_, nullptr));
    }
    return std::exchange(answer_, std::nullopt);
  }
  /// Returns whether take() has, or will have, something.
  bool busy() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return next_ || (is_running_ && !discards_) || answer_ || error_;
  }
  /// Returns whether take() has something now.
  bool ready() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return answer_ || error_;
  }
  void wait() { thread_ = JoinedThread(); }  ///< for tests

 private:
  /// @return whether no thread has to be started
  bool replace(Work work) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool starts = work && !is_running_;
    discards_ = is_running_;
    is_running_ |= starts;
    next_ = std::move(work);
    answer_.reset();
    error_ = nullptr;
    return !starts;
  }

  void run() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (next_) {
      Work work = std::exchange(next_, nullptr);
      discards_ = false;
      lock.unlock();
      std::optional<Answer> answer;
      std::exception_ptr error;
      try {
        answer = work();
      } catch (...) {
        error = std::current_exception();
      }
      work = nullptr;
      lock.lock();
      if (!discards_) {
        answer_ = std::move(answer);
        error_ = error;
      }
    }
    is_running_ = false;
    lock.unlock();
    wake_();
  }

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  Work next_;
  std::optional<Answer> answer_;
  std::exception_ptr error_;
  bool is_running_ = false;
  bool discards_ = false;  // the answer of the work in progress
  JoinedThread thread_;    // last: it ends first
};

}  // namespace lapedit
