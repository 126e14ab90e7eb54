// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/supernodal_solve.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>
#include <numeric>
#include <utility>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "lapedit/base/progress.h"
#include "lapedit/linear/multifrontal_cholesky.h"
#include "lapedit/linear/supernode_kernels.h"
#include "lapedit/linear/task_tree.h"
#include "lapedit/linear/tree_walk.h"

namespace lapedit {

using namespace supernode;

namespace {

/// Cache-aligned, uninitialised memory; large blocks use large pages, since a solve streams through them.
template <typename T>
class Buffer {
 public:
  Buffer() = default;
  ~Buffer() { release(); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  void allocate(std::size_t size) {
    constexpr std::size_t kLine = 64, kPage = std::size_t(1) << 21;
    const std::size_t alignment = size * sizeof(T) >= kPage ? kPage : kLine;
    const std::size_t bytes = (size * sizeof(T) + alignment - 1) / alignment * alignment;
    release();
    alignment_ = std::align_val_t(alignment);
    data_ = static_cast<T*>(::operator new(bytes, alignment_));
#ifdef __linux__
    if (alignment == kPage) {
      madvise(data_, bytes, MADV_HUGEPAGE);  // advice only: failure does not matter
    }
#endif
  }
  T* data() {
    return data_;
  }
  const T* data() const {
    return data_;
  }

 private:
  void release() {
    ::operator delete(std::exchange(data_, nullptr), alignment_);
  }

  T* data_ = nullptr;
  std::align_val_t alignment_{1};
};

}  // namespace

/// The factor. It does not change after construction.
template <typename Scalar>
struct SupernodalSolver<Scalar>::Tiles {
  TaskTree tree;
  Kernels<Scalar> kernels;
  Buffer<Scalar> values;
  bool definite = true;

  Tiles(const SupernodalPattern& pattern, const SparseMatrix& lower, ThreadPool& pool)
      : tree(pattern), kernels(best_kernels<Scalar>()) {
    values.allocate(tree.tiles + kAhead / sizeof(Scalar));
    const auto take = [this](int s, const double* columns, int stride) {
      const TaskTree::Node& node = tree.nodes[s];
      kernels.write_tiles(columns, stride, node.columns, node.rows, values.data() + node.tiles);
    };
    definite = multifrontal_cholesky(lower, pattern, tree, take, best_frontal_kernel(), pool);
  }
};

/// The two passes of a solve, L y = b and L^T x = y, and their memory.
template <typename Scalar>
struct SupernodalSolver<Scalar>::Passes {
  using Node = TaskTree::Node;
  using Task = TaskTree::Task;

  const Tiles& factor;
  const TaskTree& tree;
  Kernels<Scalar> kernels;
  std::vector<Scalar> lists;                 // three per entry
  std::vector<std::vector<Scalar>> vectors;  // per thread: local vectors
  TreeWalk walk;

  Passes(const Tiles& solved_with, int threads)
      : factor(solved_with),
        tree(factor.tree),
        kernels(factor.kernels),
        lists(3 * tree.list_rows.size()),
        vectors(threads, std::vector<Scalar>(3 * static_cast<std::size_t>(tree.most_rows + kWide + kTall))),
        walk(tree, threads) {}

  void forward_task(const Task& task, Scalar* x, Scalar* v);
  void backward_task(const Task& task, Scalar* x, Scalar* v);
  /// Returns the address of a row of tree.rows: in x, or in the list of a branch.
  Scalar* position_of(int row, Scalar* x) {
    return row < tree.size ? x + 3 * static_cast<std::size_t>(row)
                           : lists.data() + 3 * static_cast<std::size_t>(row - tree.size);
  }
  int pad_of(const Node& node) const { return node.rows + kWide + kTall; }
};

/// The local vectors of a supernode, by row.
template <typename Scalar>
struct Local {
  Scalar *x, *y, *z;

  Local(Scalar* v, int pad) : x(v), y(v + pad), z(v + 2 * static_cast<std::size_t>(pad)) {}
  void set(int i, const Scalar* from) const {
    x[i] = from[0];
    y[i] = from[1];
    z[i] = from[2];
  }
  void get(int i, Scalar* to) const {
    to[0] = x[i];
    to[1] = y[i];
    to[2] = z[i];
  }
  void add(int i, const Scalar* from) const {
    x[i] += from[0];
    y[i] += from[1];
    z[i] += from[2];
  }
  void add_to(int i, Scalar* to) const {
    to[0] += x[i];
    to[1] += y[i];
    to[2] += z[i];
  }
  void clear(int first, int pad) const {
    const std::size_t bytes = sizeof(Scalar) * static_cast<std::size_t>(pad - first);
    std::memset(x + first, 0, bytes);
    std::memset(y + first, 0, bytes);
    std::memset(z + first, 0, bytes);
  }
};

template <typename Scalar>
void SupernodalSolver<Scalar>::Passes::forward_task(const Task& task, Scalar* x, Scalar* v) {
  Scalar* const own = lists.data() + 3 * static_cast<std::size_t>(task.list);
  std::fill(own, own + 3 * static_cast<std::size_t>(task.list_size), Scalar(0));
  const bool branch = task.first_node < task.last_node;
  for (int s = task.first_node; s <= task.last_node; ++s) {
    const Node& node = tree.nodes[s];
    const int pad = pad_of(node);
    const Local<Scalar> local(v, pad);
    Scalar* const mine = x + 3 * static_cast<std::size_t>(node.first_column);
    for (int i = 0; i < node.columns; ++i) {
      local.set(i, mine + 3 * static_cast<std::size_t>(i));
    }
    local.clear(node.columns, pad);
    if (!branch) {
      for (int c = task.first_child; c < task.last_child; ++c) {
        const Task& child = tree.tasks[tree.child_tasks[c]];
        const Scalar* given = lists.data() + 3 * static_cast<std::size_t>(child.list);
        for (int i = child.list; i < child.list + child.list_size; ++i, given += 3) {
          local.add(tree.list_places[i], given);
        }
      }
    }
    kernels.forward(factor.values.data() + node.tiles, node.columns, node.rows, v, pad);
    for (int i = 0; i < node.columns; ++i) {
      local.get(i, mine + 3 * static_cast<std::size_t>(i));
    }
    if (branch) {
      const int* row = tree.rows.data() + node.row_offset;
      for (int i = node.columns; i < node.rows; ++i, ++row) {
        local.add_to(i, position_of(*row, x));
      }
    } else {
      Scalar* to = own;
      for (int i = node.columns; i < node.rows; ++i, to += 3) {
        local.get(i, to);
      }
    }
  }
}

template <typename Scalar>
void SupernodalSolver<Scalar>::Passes::backward_task(const Task& task, Scalar* x, Scalar* v) {
  Scalar* own = lists.data() + 3 * static_cast<std::size_t>(task.list);
  for (int i = task.list; i < task.list + task.list_size; ++i, own += 3) {
    std::memcpy(own, x + 3 * static_cast<std::size_t>(tree.list_rows[i]), 3 * sizeof(Scalar));
  }
  for (int s = task.last_node; s >= task.first_node; --s) {
    const Node& node = tree.nodes[s];
    const int pad = pad_of(node);
    const Local<Scalar> local(v, pad);
    Scalar* const mine = x + 3 * static_cast<std::size_t>(node.first_column);
    for (int i = 0; i < node.columns; ++i) {
      local.set(i, mine + 3 * static_cast<std::size_t>(i));
    }
    const int* row = tree.rows.data() + node.row_offset;
    for (int i = node.columns; i < node.rows; ++i, ++row) {
      local.set(i, position_of(*row, x));
    }
    local.clear(node.rows, pad);
    kernels.backward(factor.values.data() + node.tiles + tiles_of(node.columns, node.rows), node.columns, node.rows, v,
                     pad);
    for (int i = 0; i < node.columns; ++i) {
      local.get(i, mine + 3 * static_cast<std::size_t>(i));
    }
  }
}

template <typename Scalar>
SupernodalSolver<Scalar>::SupernodalSolver(const SupernodalPattern& pattern, const SparseMatrix& lower,
                                           ThreadPool& pool)
    : tiles_(std::make_shared<const Tiles>(pattern, lower, pool)),
      passes_(std::make_unique<Passes>(*tiles_, pool.threads())) {}

template <typename Scalar>
bool SupernodalSolver<Scalar>::positive_definite() const {
  return tiles_->definite;
}

template <typename Scalar>
SupernodalSolver<Scalar>::SupernodalSolver(const SupernodalSolver& other, const ThreadPool& pool)
    : tiles_(other.tiles_), passes_(std::make_unique<Passes>(*tiles_, pool.threads())) {}

template <typename Scalar>
SupernodalSolver<Scalar>::~SupernodalSolver() = default;

template <typename Scalar>
void SupernodalSolver<Scalar>::solve(Scalar* x, ThreadPool& pool) {
  Passes& p = *passes_;
  p.walk.upwards(pool, [&](const auto& task, int thread) { p.forward_task(task, x, p.vectors[thread].data()); });
  p.walk.downwards(pool, [&](const auto& task, int thread) { p.backward_task(task, x, p.vectors[thread].data()); });
}

template <typename Scalar>
std::vector<HalfColumn> SupernodalSolver<Scalar>::half_columns(const std::vector<int>& rows, ThreadPool& pool) const {
  constexpr std::size_t kTogether = 3;
  const TaskTree& tree = tiles_->tree;
  const std::vector<TaskTree::Node>& nodes = tree.nodes;
  const auto node_of = [&](int row) {
    return static_cast<int>(std::upper_bound(nodes.begin(), nodes.end(), row,
                                             [](int r, const TaskTree::Node& node) { return r < node.first_column; }) -
                            nodes.begin()) -
           1;
  };
  std::vector<std::size_t> sorted(rows.size());  // rows that share most of their supernodes are next to each other
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) { return rows[a] < rows[b]; });
  std::vector<HalfColumn> halves(rows.size());
  pool.each(static_cast<int>((rows.size() + kTogether - 1) / kTogether), [&](int group) {
    const std::size_t begin = kTogether * static_cast<std::size_t>(group);
    const std::size_t end = std::min(begin + kTogether, rows.size());
    std::vector<int> path, offsets = {0};
    for (std::size_t k = begin; k < end; ++k) {
      for (int s = node_of(rows[sorted[k]]); s >= 0; s = nodes[s].parent) {
        path.push_back(s);
      }
    }
    std::sort(path.begin(), path.end());
    path.erase(std::unique(path.begin(), path.end()), path.end());
    for (const int s : path) {
      offsets.push_back(offsets.back() + nodes[s].columns);
    }
    const auto index_of = [&](int s) { return std::lower_bound(path.begin(), path.end(), s) - path.begin(); };
    std::vector<Scalar> x(kTogether * static_cast<std::size_t>(offsets.back())),
        v(kTogether * static_cast<std::size_t>(tree.most_rows + kWide + kTall));
    const auto at = [&](std::size_t p, int row) {
      return x.data() + kTogether * static_cast<std::size_t>(offsets[p] + row - nodes[path[p]].first_column);
    };
    for (std::size_t k = begin; k < end; ++k) {
      at(index_of(node_of(rows[sorted[k]])), rows[sorted[k]])[k - begin] = 1;
    }
    for (std::size_t p = 0; p < path.size(); ++p) {
      const TaskTree::Node& node = nodes[path[p]];
      const int pad = node.rows + kWide + kTall;
      const Local<Scalar> local(v.data(), pad);
      checkpoint(node.rows);
      for (int i = 0; i < node.columns; ++i) {
        local.set(i, at(p, node.first_column + i));
      }
      local.clear(node.columns, pad);
      tiles_->kernels.forward(tiles_->values.data() + node.tiles, node.columns, node.rows, v.data(), pad);
      for (int i = 0; i < node.columns; ++i) {
        local.get(i, at(p, node.first_column + i));
      }
      std::size_t above = p;
      for (int i = node.columns; i < node.rows; ++i) {
        int row = tree.rows[static_cast<std::size_t>(node.row_offset + i - node.columns)];
        row = row < tree.size ? row : tree.list_rows[static_cast<std::size_t>(row - tree.size)];
        while (row >= nodes[path[above]].first_column + nodes[path[above]].columns) {
          ++above;
        }
        local.add_to(i, at(above, row));
      }
    }
    for (std::size_t k = begin; k < end; ++k) {
      HalfColumn& half = halves[sorted[k]];
      for (int s = node_of(rows[sorted[k]]); s >= 0; s = nodes[s].parent) {
        half.blocks.push_back({nodes[s].first_column, nodes[s].columns});
        const Scalar* value = at(index_of(s), nodes[s].first_column) + (k - begin);
        for (int i = 0; i < nodes[s].columns; ++i, value += kTogether) {
          half.values.push_back(static_cast<double>(*value));
        }
      }
    }
  });
  return halves;
}

template class SupernodalSolver<float>;
template class SupernodalSolver<double>;

}  // namespace lapedit
