// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <thread>
#include <utility>

namespace lapedit {

/// A thread that is joined when it is replaced or destroyed. It runs a std::packaged_task in place of std::async(),
/// which waits forever in libc++ if the system allows no thread.
class JoinedThread {
 public:
  JoinedThread() = default;
  /// @throws std::system_error if no thread is available
  template <class Task>
  explicit JoinedThread(Task task) : thread_(std::move(task)) {}
  JoinedThread(JoinedThread&&) = default;
  JoinedThread& operator=(JoinedThread&& other) noexcept {
    join();
    thread_ = std::move(other.thread_);
    return *this;
  }
  ~JoinedThread() { join(); }

 private:
  void join() {
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  std::thread thread_;
};

}  // namespace lapedit
