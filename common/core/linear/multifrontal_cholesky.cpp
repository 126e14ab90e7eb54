// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/multifrontal_cholesky.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/linear/tree_walk.h"

namespace lapedit::supernode {
namespace {

constexpr std::align_val_t kLine{64};
constexpr int kWordsPerWork = 32;  // numbers of a front that are set or added for a unit of work, see checkpoint()

struct Free {
  void operator()(double* memory) const { ::operator delete(memory, kLine); }
};
using Memory = std::unique_ptr<double, Free>;

/// Reuses the memory of fronts, since new pages cost more time than small fronts.
class Recycler {
 public:
  Memory take(std::size_t size, int& kind) {
    constexpr std::size_t kLeast = 64;
    kind = 0;
    while ((kLeast << kind) < size) {
      ++kind;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<Memory>& free = free_[kind];
    if (!free.empty()) {
      Memory memory = std::move(free.back());
      free.pop_back();
      return memory;
    }
    return Memory(static_cast<double*>(::operator new((kLeast << kind) * sizeof(double), kLine)));
  }
  void give(Memory memory, int kind) {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_[kind].push_back(std::move(memory));
  }

 private:
  std::mutex mutex_;
  std::vector<Memory> free_[48];
};

class Factorisation {
 public:
  Factorisation(const SparseMatrix& lower, const SupernodalPattern& pattern, const TaskTree& tree,
                const std::function<void(int, const double*, int)>& take, FrontalKernel kernel, ThreadPool& pool)
      : lower_(lower),
        pattern_(pattern),
        tree_(tree),
        take_(take),
        pool_(pool),
        kernel_(kernel),
        children_(lists_of(static_cast<int>(tree.nodes.size()),
                           [&tree](const auto& use) {
                             for (int s = 0; s < static_cast<int>(tree.nodes.size()); ++s) {
                               if (const int parent = tree.nodes[s].parent; parent >= 0) {
                                 use(parent, s);
                               }
                             }
                           })),
        fronts_(tree.nodes.size()),
        positions_(pool.threads(), std::vector<int>(tree.size)) {}

  bool run() {
    TreeWalk walk(tree_, pool_.threads());
    walk.upwards(pool_, [&](const TaskTree::Task& task, int worker) {
      Checkpoints checkpoints;
      for (int s = task.first_node; s <= task.last_node && definite_; ++s) {
        checkpoints(work(s));
        eliminate(s, positions_[worker].data());
      }
    });
    return definite_;
  }

 private:
  struct Front {
    Memory memory;
    int kind = 0;
  };

  int columns(int s) const { return tree_.nodes[s].columns; }
  int size(int s) const { return tree_.nodes[s].rows; }
  /// Returns the work of a small front, see checkpoint(); eliminate() counts that of a large one itself.
  int work(int s) const {
    constexpr std::int64_t kLeast = 4, kMost = 1024, kProducts = 2048;
    return static_cast<int>(std::min(kMost, kLeast + std::int64_t{size(s)} * size(s) * columns(s) / kProducts));
  }
  int stride(int s) const { return (size(s) + kFrontLanes - 1) / kFrontLanes * kFrontLanes; }
  const int* rows(int s) const { return pattern_.rows.data() + pattern_.row_offsets[s]; }

  void eliminate(int s, int* position);
  void add_matrix(int s, const int* position, double* front) const;
  void add_child(int child, const int* position, double* front, int front_stride);

  const SparseMatrix& lower_;
  const SupernodalPattern& pattern_;
  const TaskTree& tree_;
  const std::function<void(int, const double*, int)>& take_;
  ThreadPool& pool_;
  FrontalKernel kernel_;
  CompressedRows children_;
  std::vector<Front> fronts_;
  std::vector<std::vector<int>> positions_;  // per thread: row -> position in the front
  Recycler recycler_;
  std::atomic<bool> definite_{true};
};

void Factorisation::add_matrix(int s, const int* position, double* front) const {
  const int first = tree_.nodes[s].first_column;
  for (int j = first; j < first + columns(s); ++j) {
    double* const column = front + static_cast<std::size_t>(j - first) * stride(s);
    for (SparseMatrix::InnerIterator entry(lower_, j); entry; ++entry) {
      column[position[entry.row()]] = entry.value();
    }
  }
}

/// Adds a child's update of the rows below its columns to a front.
void Factorisation::add_child(int child, const int* position, double* front, int front_stride) {
  const int first = columns(child), last = size(child), child_stride = stride(child);
  const int* const row = rows(child);
  const double* from = fronts_[child].memory.get() + static_cast<std::size_t>(first) * child_stride;
  Checkpoints checkpoints;
  for (int j = first; j < last; ++j, from += child_stride) {
    checkpoints((last - j) / kWordsPerWork);
    double* const to = front + static_cast<std::size_t>(position[row[j]]) * front_stride;
    for (int i = j; i < last; ++i) {
      to[position[row[i]]] += from[i];
    }
  }
  recycler_.give(std::move(fronts_[child].memory), fronts_[child].kind);
}

void Factorisation::eliminate(int s, int* position) {
  const int front_size = size(s), front_stride = stride(s);
  for (int i = 0; i < front_size; ++i) {
    position[rows(s)[i]] = i;
  }
  Front& front = fronts_[s];
  front.memory = recycler_.take(static_cast<std::size_t>(front_stride) * front_size, front.kind);
  double* const values = front.memory.get();
  Checkpoints checkpoints;
  for (int j = 0; j < front_size; ++j) {
    checkpoints(front_size / kWordsPerWork);
    const int start = j / kFrontLanes * kFrontLanes;
    std::memset(values + static_cast<std::size_t>(j) * front_stride + start, 0,
                static_cast<std::size_t>(front_stride - start) * sizeof(double));
  }
  add_matrix(s, position, values);
  for (const int child : children_[s]) {
    add_child(child, position, values, front_stride);
  }
  if (!kernel_(values, front_stride, front_size, columns(s))) {
    definite_ = false;
    return;
  }
  take_(s, values, front_stride);
  if (front_size == columns(s)) {
    recycler_.give(std::move(front.memory), front.kind);
  }
}

}  // namespace

bool multifrontal_cholesky(const SparseMatrix& lower, const SupernodalPattern& pattern, const TaskTree& tree,
                           const std::function<void(int supernode, const double* columns, int stride)>& take,
                           FrontalKernel kernel, ThreadPool& pool) {
  return Factorisation(lower, pattern, tree, take, kernel, pool).run();
}

}  // namespace lapedit::supernode
