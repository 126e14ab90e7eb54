// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/background_task.h"

#include <gtest/gtest.h>

#include <future>
#include <string>

namespace lapedit::background_task_test {
namespace {

TEST(BackgroundTask, NewestWorkIsAnsweredAndWaitingWorkIsSkipped) {
  std::promise<void> begun, gate;
  std::string done;
  BackgroundTask<char> task([] {});
  task.start([&] {
    begun.set_value();
    gate.get_future().wait();
    done += 'a';
    return 'a';
  });
  begun.get_future().wait();
  for (const char name : {'b', 'c'}) {
    task.start([&done, name] {
      done += name;
      return name;
    });
  }
  EXPECT_EQ(task.take(), std::nullopt);
  gate.set_value();
  task.wait();
  EXPECT_EQ(done, "ac");
  EXPECT_TRUE(task.busy());
  EXPECT_EQ(task.take(), 'c');
  EXPECT_FALSE(task.busy());
}

TEST(BackgroundTask, WorkThatReplacesAnotherBeforeItBeginsIsAnswered) {
  for (int round = 0; round < 100; ++round) {  // the thread begins before, between or after these calls
    BackgroundTask<int> task([] {});
    for (int k = 0; k < 3; ++k) {
      task.start([k] { return k; });
    }
    task.wait();
    EXPECT_EQ(task.take(), 2);
  }
}

TEST(BackgroundTask, ErrorIsThrownOnceAndLaterWorkIsAnswered) {
  int woken = 0;
  BackgroundTask<int> task([&woken] { ++woken; });
  task.start([]() -> int { throw std::bad_alloc(); });
  task.wait();
  EXPECT_EQ(woken, 1);
  EXPECT_THROW(task.take(), std::bad_alloc);
  EXPECT_FALSE(task.busy());
  EXPECT_EQ(task.take(), std::nullopt);
  task.start([] { return 7; });
  task.wait();
  EXPECT_EQ(task.take(), 7);
}

TEST(BackgroundTask, CancelledWorkHasNoAnswer) {
  std::promise<void> gate;
  BackgroundTask<int> task([] {});
  task.start([&gate] {
    gate.get_future().wait();
    return 7;
  });
  task.cancel();
  EXPECT_FALSE(task.busy());
  gate.set_value();
  task.wait();
  EXPECT_EQ(task.take(), std::nullopt);
}

}  // namespace
}  // namespace lapedit::background_task_test
