// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "lapedit/linear/elimination_tree.h"

namespace lapedit::supernode {

/// Shares the tasks of an elimination tree among the threads of a pool. Made once; a walk allocates nothing. One at a
/// time.
class TreeWalk {
 public:
  /// @param tree  must outlive the object
  TreeWalk(const EliminationTree& tree, int threads)
      : tree_(tree),
        threads_(threads),
        pending_(tree.tasks.size()),
        queue_(tree.tasks.size()),
        ready_(tree.tasks.size()) {}

  /// Calls body(task, thread) for each task after its children. What one throws reaches the caller.
  template <class Body>
  void upwards(ThreadPool& pool, const Body& body) {
    walk(pool, true, body);
  }
  /// After its parent.
  template <class Body>
  void downwards(ThreadPool& pool, const Body& body) {
    walk(pool, false, body);
  }

 private:
  using Task = EliminationTree::Task;

  template <class Body>
  void walk(ThreadPool& pool, bool up, const Body& body) {
    const int count = static_cast<int>(tree_.tasks.size());
    if (threads_ == 1) {
      for (int t = 0; t < count; ++t) {
        body(tree_.tasks[up ? t : count - 1 - t], 0);
      }
      return;
    }
    start(up);
    pool.each(threads_, [&](int thread) {
      int task = 0;
      while (next(task)) {
        try {
          body(tree_.tasks[task], thread);
        } catch (...) {
          failed_ = true;  // nobody is to wait for what comes after it
          throw;
        }
        release(tree_.tasks[task], up);
      }
    });
  }

  void start(bool up) {
    failed_ = false;
    for (std::size_t t = 0; t < tree_.tasks.size(); ++t) {
      pending_[t].store(up ? tree_.tasks[t].children() : 1, std::memory_order_relaxed);
      ready_[t].store(0, std::memory_order_relaxed);
    }
    head_ = tail_ = 0;
    for (const int task : up ? tree_.leaves : tree_.roots) {
      push(task);
    }
  }

  void push(int task) {
    const int place = tail_++;
    queue_[place] = task;
    ready_[place].store(1, std::memory_order_release);
  }

  bool next(int& task) {
    const int place = head_++;
    if (place >= static_cast<int>(queue_.size())) {
      return false;
    }
    while (ready_[place].load(std::memory_order_acquire) == 0) {
      if (failed_) {
        return false;
      }
      std::this_thread::yield();
    }
    task = queue_[place];
    return true;
  }

  void release(const Task& done, bool up) {
    if (!up) {
      for (int c = done.first_child; c < done.last_child; ++c) {
        push(tree_.child_tasks[c]);
      }
    } else if (done.parent >= 0 && --pending_[done.parent] == 0) {
      push(done.parent);
    }
  }

  const EliminationTree& tree_;
  int threads_;
  std::vector<std::atomic<int>> pending_;
  std::vector<int> queue_;
  std::vector<std::atomic<int>> ready_;
  std::atomic<int> head_{0}, tail_{0};
  std::atomic<bool> failed_{false};
};

}  // namespace lapedit::supernode
