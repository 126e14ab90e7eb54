// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <mutex>
#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/linear/task_tree.h"

namespace lapedit::supernode {

/// Shares the tasks of a tree among the threads of a pool. A walk allocates nothing. One walk at a time.
class TreeWalk {
 public:
  /// @param tree  must outlive the object
  TreeWalk(const TaskTree& tree, int threads)
      : tree_(tree), threads_(threads), pending_(tree.tasks.size()), queue_(tree.tasks.size()) {}

  /// Calls body(task, thread) for each task after its children. Exceptions reach the caller.
  template <class Body>
  void upwards(ThreadPool& pool, const Body& body) {
    walk(pool, true, body);
  }
  /// Calls body(task, thread) for each task after its parent.
  template <class Body>
  void downwards(ThreadPool& pool, const Body& body) {
    walk(pool, false, body);
  }

 private:
  using Task = TaskTree::Task;

  template <class Body>
  void walk(ThreadPool& pool, bool up, const Body& body) {
    const int count = static_cast<int>(tree_.tasks.size());
    if (threads_ == 1) {
      for (int t = 0; t < count; ++t) {
        visit(tree_.tasks[up ? t : count - 1 - t], 0, body);
      }
      return;
    }
    start(up);
    pool.each(threads_, [&](int thread) {
      try {
        int task = kNone;
        while (task != kNone || next(pool, task)) {
          visit(tree_.tasks[task], thread, body);
          task = release(tree_.tasks[task], up);
        }
      } catch (...) {
        failed_ = true;  // ends the waiting for tasks that depend on it
        gate_.open();
        throw;
      }
    });
  }

  template <class Body>
  static void visit(const Task& task, int thread, const Body& body) {
    constexpr int kWork = 64;  // of a supernode
    body(task, thread);
    checkpoint(kWork * (task.last_node - task.first_node + 1));
  }

  void start(bool up) {
    failed_ = false;
    for (std::size_t t = 0; t < tree_.tasks.size(); ++t) {
      pending_[t].store(up ? tree_.tasks[t].children() : 1, std::memory_order_relaxed);
    }
    left_ = static_cast<int>(tree_.tasks.size());
    head_ = tail_ = 0;
    for (const int task : up ? tree_.leaves : tree_.roots) {
      queue_[tail_++] = task;
    }
  }

  bool over() const { return failed_ || left_ == 0; }

  /// Waits for a task that no thread works on. @return false if there will be none
  bool next(ThreadPool& pool, int& task) {
    while (!over()) {
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (head_ < tail_) {
          task = queue_[head_++];
          return true;
        }
      }
      pool.wait(gate_, [this] { return head_ < tail_ || over(); });
    }
    return false;
  }

  /// Releases the tasks that waited for this one only: the calling thread takes the first of them, idle threads the
  /// others.
  int release(const Task& done, bool up) {
    int first = kNone, others = 0;
    const auto give = [&](int task) {
      if (first == kNone) {
        first = task;
        return;
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      queue_[tail_++] = task;
      ++others;
    };
    if (!up) {
      for (int c = done.first_child; c < done.last_child; ++c) {
        give(tree_.child_tasks[c]);
      }
    } else if (done.parent >= 0 && --pending_[done.parent] == 0) {
      give(done.parent);
    }
    if (--left_ == 0 || others > 0) {
      gate_.open();
    }
    return failed_ ? kNone : first;
  }

  static constexpr int kNone = -1;
  const TaskTree& tree_;
  int threads_;
  std::vector<std::atomic<int>> pending_;
  std::vector<int> queue_;
  std::mutex mutex_;
  std::atomic<int> head_{0}, tail_{0};  // of the queue: changed under the mutex
  std::atomic<int> left_{0};            // tasks not done
  Gate gate_;
  std::atomic<bool> failed_{false};
};

}  // namespace lapedit::supernode
