// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/task_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "lapedit/linear/tree_walk.h"

namespace lapedit::supernode::task_tree_test {
namespace {

/// The tree of a factor of `leaves` columns that all have one more row, the last column's: a star.
TaskTree star(int leaves) {
  SupernodalPattern pattern;
  pattern.columns = pattern.row_offsets = {0};
  for (int j = 0; j <= leaves; ++j) {
    pattern.rows.push_back(j);
    if (j < leaves) {
      pattern.rows.push_back(leaves);
    }
    pattern.columns.push_back(j + 1);
    pattern.row_offsets.push_back(static_cast<int>(pattern.rows.size()));
  }
  return TaskTree(pattern);
}

/// A thread that gets no processor: fails if other tasks wait for it than those above or below its task.
TEST(TreeWalk, ThreadThatIsHeldUpHoldsUpNothingButItsTask) {
  const TaskTree tree = star(40);
  const int tasks = static_cast<int>(tree.tasks.size());
  const auto caller = std::this_thread::get_id();
  for (const bool up : {true, false}) {
    // A new one: the old one may go on alone for a while, since waiting for its helper has cost so much.
    ThreadPool pool(2);
    TreeWalk walk(tree, pool.threads());
    std::atomic<int> done{0};
    std::atomic<bool> helped{false}, others_done{!up};
    std::vector<int> times(tasks, 0);
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    const auto wait_for = [&](const auto& what) {
      while (!what() && std::chrono::steady_clock::now() < limit) {
        std::this_thread::yield();
      }
      return what();
    };
    const auto work = [&](const TaskTree::Task& task, int) {
      const bool leaf = task.parent >= 0;
      if (leaf && std::this_thread::get_id() != caller && !helped) {
        helped = true;
        others_done = wait_for([&] { return done == (up ? tasks - 2 : tasks - 1); });
      } else if (leaf) {
        wait_for([&] { return helped.load(); });
      }
      ++times[&task - tree.tasks.data()];
      ++done;
    };
    up ? walk.upwards(pool, work) : walk.downwards(pool, work);
    EXPECT_TRUE(helped && others_done) << (up ? "upwards" : "downwards");
    EXPECT_EQ(times, std::vector<int>(tasks, 1));
  }
}

}  // namespace
}  // namespace lapedit::supernode::task_tree_test
