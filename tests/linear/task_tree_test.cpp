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

/// Fails if a column is lost, done twice or cut from its parent.
TEST(TaskTree, TasksCoverAllSupernodesOnceAndKnowTheirParents) {
  for (const int leaves : {1, 3, 40, 500}) {
    const TaskTree tree = star(leaves);
    std::vector<int> seen(leaves + 1, 0);
    int children = 0;
    for (std::size_t t = 0; t < tree.tasks.size(); ++t) {
      const TaskTree::Task& task = tree.tasks[t];
      ASSERT_LE(task.first_node, task.last_node);
      for (int s = task.first_node; s <= task.last_node; ++s) {
        ++seen[s];
      }
      for (int c = task.first_child; c < task.last_child; ++c, ++children) {
        EXPECT_EQ(tree.tasks[tree.child_tasks[c]].parent, static_cast<int>(t));
      }
    }
    EXPECT_EQ(seen, std::vector<int>(leaves + 1, 1));
    EXPECT_EQ(tree.roots, std::vector<int>{static_cast<int>(tree.tasks.size()) - 1});
    EXPECT_EQ(children, static_cast<int>(tree.tasks.size()) - 1) << "all but the root";
    EXPECT_EQ(tree.most_rows, 2);
  }
}

/// Fails if what a task hands up does not arrive at the row that it is meant for.
TEST(TaskTree, ListsNameTheParentsRows) {
  const TaskTree tree = star(40);
  ASSERT_EQ(tree.tasks.size(), 41U) << "a branch ends below the supernode that all hang on";
  EXPECT_EQ(tree.list_rows, std::vector<int>(40, 40));
  EXPECT_EQ(tree.list_places, std::vector<int>(40, 0)) << "the parent's column";
  EXPECT_EQ(tree.leaves.size(), 40U);
}

/// A thread that gets no processor: fails if other tasks wait for it than those above or below its task.
TEST(TreeWalk, ThreadThatIsHeldUpHoldsUpNothingButItsTask) {
  const TaskTree tree = star(40);
  const int tasks = static_cast<int>(tree.tasks.size());
  const auto caller = std::this_thread::get_id();
  for (const bool up : {true, false}) {
    // A new one, whose threads have no work of the other direction.
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
