// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <thread>

#include "lapedit/edit/step_runner.h"

namespace lapedit {

/// Makes a StepRunner on a thread of its own, one at a time. All functions are for one thread and return at once, but
/// for the destructor.
class BackgroundPreparation {
 public:
  using Make = std::function<std::unique_ptr<StepRunner>()>;

  /// @param ended  called from the thread at work when it is done
  explicit BackgroundPreparation(std::function<void()> ended) : ended_callback_(std::move(ended)) {}
  /// Waits until what is being made is done or notices that it is not wanted.
  ~BackgroundPreparation();

  /// Only while there is nothing at work.
  void start(Make make);
  bool at_work() const { return thread_.joinable(); }  ///< started and not taken yet
  bool ended() const { return ended_; }                ///< for any thread: take() has something

  /// What was made, after ended(). @throws what stopped it
  std::unique_ptr<StepRunner> take();

 private:
  std::function<void()> ended_callback_;
  std::thread thread_;
  std::atomic<bool> ended_{false};
  std::unique_ptr<StepRunner> made_;
  std::exception_ptr error_;
};

}  // namespace lapedit
