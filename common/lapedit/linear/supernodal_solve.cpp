// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tree. Small branches of the elimination tree are one task each; every supernode above them is a task of its own. A
// task adds what it has for rows above it into a list of its own, which its parent takes over in the order of its
// children.
#include "lapedit/linear/supernodal_solve.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "lapedit/linear/supernode_kernels.h"

namespace lapedit {

using namespace supernode;

namespace {

/// Cache-aligned and not initialised; large ones in large pages, since a solve streams through them.
template <typename T>
class Buffer {
 public:
  Buffer() = default;
  ~Buffer() { std::free(data_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  void allocate(std::size_t size) {
    constexpr std::size_t kLine = 64, kPage = std::size_t(1) << 21;
    const std::size_t alignment = size * sizeof(T) >= kPage ? kPage : kLine;
    const std::size_t bytes = (size * sizeof(T) + alignment - 1) / alignment * alignment;
    std::free(data_);
    data_ = static_cast<T*>(std::aligned_alloc(alignment, std::max(bytes, alignment)));
    if (!data_) {
      throw std::bad_alloc();
    }
    size_ = size;
#ifdef __linux__
    if (alignment == kPage) {
      madvise(data_, bytes, MADV_HUGEPAGE);  // only advice: nothing to do if it is not taken
    }
#endif
  }
  T* data() {
    return data_;
  }
  const T* data() const {
    return data_;
  }
  std::size_t size() const {
    return size_;
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace

template <typename Scalar>
struct SupernodalSolver<Scalar>::Inside {
  struct Node {  // a supernode
    int first_column, columns, rows;
    int row_offset;     // of its rows below its own columns, in rows
    std::size_t tiles;  // offset
  };
  struct Task {
    int first_node, last_node;  // a branch, or one supernode
    int parent;                 // -1: a root
    int first_child, last_child;
    int list;  // its rows above it: offset in list_rows, and in lists
    int list_size;
    int children;
  };

  int size = 0;
  Kernels<Scalar> kernels = best_kernels<Scalar>();
  std::vector<Node> nodes;
  std::vector<int> rows;  // below a supernode: a row of x, or size + a place in the branch's list
  std::vector<Task> tasks;
  std::vector<int> list_rows;    // rows of x
  std::vector<int> list_places;  // the same for the parent: its local row
  std::vector<int> child_tasks;  // by parent
  Buffer<Scalar> tiles;
  std::vector<Scalar> lists;               // three per entry
  std::vector<std::vector<Scalar>> local;  // per thread: local vectors
  std::vector<std::atomic<int>> pending;
  std::vector<int> queue;
  std::atomic<int> queue_head{0}, queue_tail{0}, finished{0};
  std::vector<std::atomic<int>> queue_ready;
  std::vector<int> leaves;  // tasks without children
  std::vector<int> roots;
  int most_rows = 0;

  void build(const SupernodalFactor& factor, ThreadPool& pool);
  void make_tasks(const SupernodalFactor& factor);
  void run_tasks(ThreadPool& pool, Scalar* x, bool forward);
  void forward_task(const Task& task, Scalar* x, Scalar* v);
  void backward_task(const Task& task, Scalar* x, Scalar* v);
  int pad_of(const Node& node) const { return node.rows + kWide + kTall; }
};

template <typename Scalar>
void SupernodalSolver<Scalar>::Inside::build(const SupernodalFactor& factor, ThreadPool& pool) {
  size = factor.size;
  nodes.resize(factor.supernodes);
  rows.assign(factor.rows, factor.rows + factor.row_offsets[factor.supernodes]);
  std::size_t total = 0;
  for (int s = 0; s < factor.supernodes; ++s) {
    Node& node = nodes[s];
    node.first_column = factor.columns[s];
    node.columns = factor.columns[s + 1] - factor.columns[s];
    node.rows = factor.row_offsets[s + 1] - factor.row_offsets[s];
    node.row_offset = factor.row_offsets[s] + node.columns;
    node.tiles = total;
    total += tiles_of(node.columns, node.rows);
    most_rows = std::max(most_rows, node.rows);
  }
  tiles.allocate(total + kAhead / sizeof(Scalar));
  constexpr int kGrain = 64;
  in_pieces(pool, factor.supernodes, kGrain, [&](int first, int last) {
    for (int s = first; s < last; ++s) {
      write_tiles(factor.values + factor.value_offsets[s], nodes[s].columns, nodes[s].rows,
                  tiles.data() + nodes[s].tiles);
    }
  });
  make_tasks(factor);
  local.resize(pool.threads());
  for (std::vector<Scalar>& v : local) {
    v.assign(3 * static_cast<std::size_t>(most_rows + kWide + kTall), 0);
  }
  lists.assign(3 * list_rows.size(), 0);
  pending = std::vector<std::atomic<int>>(tasks.size());
  queue.assign(tasks.size(), 0);
  queue_ready = std::vector<std::atomic<int>>(tasks.size());
}

/// Cuts the tree into branches of at most a share of all work, and supernodes above them.
template <typename Scalar>
void SupernodalSolver<Scalar>::Inside::make_tasks(const SupernodalFactor& factor) {
  constexpr double kShare = 1.0 / 24;
  const int count = factor.supernodes;
  std::vector<int> node_of_column(size), parent(count, -1), first_of_branch(count);
  for (int s = 0; s < count; ++s) {
    for (int j = factor.columns[s]; j < factor.columns[s + 1]; ++j) {
      node_of_column[j] = s;
    }
  }
  std::vector<double> work(count);
  for (int s = 0; s < count; ++s) {
    first_of_branch[s] = s;
  }
  double all = 0;
  bool postordered = true;
  for (int s = 0; s < count; ++s) {
    const Node& node = nodes[s];
    // What a supernode costs beyond reading it: gathering and scattering its rows.
    work[s] += static_cast<double>(node.columns) * node.rows + 6.0 * node.rows;
    all += static_cast<double>(node.columns) * node.rows + 6.0 * node.rows;
    if (node.rows > node.columns) {
      parent[s] = node_of_column[rows[node.row_offset]];
      work[parent[s]] += work[s];
      first_of_branch[parent[s]] = std::min(first_of_branch[parent[s]], first_of_branch[s]);
    }
  }
  // Branches have to be runs of consecutive supernodes.
  std::vector<int> branch_size(count, 1);
  for (int s = 0; s < count; ++s) {
    if (parent[s] >= 0) {
      branch_size[parent[s]] += branch_size[s];
    }
    postordered = postordered && branch_size[s] == s - first_of_branch[s] + 1;
  }
  std::vector<int> task_of(count, -1);
  for (int s = 0; s < count; ++s) {
    const bool small = postordered && work[s] <= kShare * all;
    const bool parent_small = parent[s] >= 0 && postordered && work[parent[s]] <= kShare * all;
    if (small && parent_small) {
      continue;  // inside a branch
    }
    Task task{};
    task.first_node = small ? first_of_branch[s] : s;
    task.last_node = s;
    task.parent = -1;
    task.list = static_cast<int>(list_rows.size());
    task.list_size = nodes[s].rows - nodes[s].columns;
    task_of[s] = static_cast<int>(tasks.size());
    list_rows.insert(list_rows.end(), rows.begin() + nodes[s].row_offset,
                     rows.begin() + nodes[s].row_offset + task.list_size);
    tasks.push_back(task);
  }
  list_places.resize(list_rows.size());
  std::vector<std::vector<int>> children(tasks.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    Task& task = tasks[t];
    const int top = task.last_node;
    if (parent[top] < 0) {
      roots.push_back(static_cast<int>(t));
      continue;
    }
    task.parent = task_of[parent[top]];
    children[task.parent].push_back(static_cast<int>(t));
    const Node& above = nodes[parent[top]];
    int place = 0;
    for (int i = task.list; i < task.list + task.list_size; ++i) {
      if (list_rows[i] < above.first_column + above.columns) {
        list_places[i] = list_rows[i] - above.first_column;
        continue;
      }
      while (rows[above.row_offset + place] != list_rows[i]) {
        ++place;
      }
      list_places[i] = above.columns + place;
    }
  }
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    Task& task = tasks[t];
    task.first_child = static_cast<int>(child_tasks.size());
    child_tasks.insert(child_tasks.end(), children[t].begin(), children[t].end());
    task.last_child = static_cast<int>(child_tasks.size());
    task.children = static_cast<int>(children[t].size());
    if (task.children == 0) {
      leaves.push_back(static_cast<int>(t));
    }
  }
  // Inside a branch, rows above it are named by their place in its list. Only now, since the loop above reads rows of
  // supernodes that are tasks of their own, which stay.
  for (const Task& task : tasks) {
    const int end = nodes[task.last_node].first_column + nodes[task.last_node].columns;
    const int* const list_begin = list_rows.data() + task.list;
    for (int s = task.first_node; task.first_node < task.last_node && s <= task.last_node; ++s) {
      int place = 0;
      for (int i = nodes[s].row_offset; i < nodes[s].row_offset + nodes[s].rows - nodes[s].columns; ++i) {
        if (rows[i] >= end) {
          while (list_begin[place] != rows[i]) {
            ++place;
          }
          rows[i] = size + task.list + place;
        }
      }
    }
  }
}

template <typename Scalar>
void SupernodalSolver<Scalar>::Inside::forward_task(const Task& task, Scalar* x, Scalar* v) {
  Scalar* const own = lists.data() + 3 * static_cast<std::size_t>(task.list);
  std::fill(own, own + 3 * static_cast<std::size_t>(task.list_size), Scalar(0));
  const bool branch = task.first_node < task.last_node;
  for (int s = task.first_node; s <= task.last_node; ++s) {
    const Node& node = nodes[s];
    const int pad = pad_of(node);
    Scalar* const px = v;
    Scalar* const py = v + pad;
    Scalar* const pz = v + 2 * static_cast<std::size_t>(pad);
    const Scalar* in = x + 3 * static_cast<std::size_t>(node.first_column);
    for (int i = 0; i < node.columns; ++i, in += 3) {
      px[i] = in[0];
      py[i] = in[1];
      pz[i] = in[2];
    }
    const std::size_t tail = sizeof(Scalar) * static_cast<std::size_t>(pad - node.columns);
    std::memset(px + node.columns, 0, tail);
    std::memset(py + node.columns, 0, tail);
    std::memset(pz + node.columns, 0, tail);
    if (!branch) {
      for (int c = task.first_child; c < task.last_child; ++c) {
        const Task& child = tasks[child_tasks[c]];
        const Scalar* given = lists.data() + 3 * static_cast<std::size_t>(child.list);
        for (int i = child.list; i < child.list + child.list_size; ++i, given += 3) {
          const int place = list_places[i];
          px[place] += given[0];
          py[place] += given[1];
          pz[place] += given[2];
        }
      }
    }
    kernels.forward(tiles.data() + node.tiles, node.columns, node.rows, v, pad);
    Scalar* out = x + 3 * static_cast<std::size_t>(node.first_column);
    for (int i = 0; i < node.columns; ++i, out += 3) {
      out[0] = px[i];
      out[1] = py[i];
      out[2] = pz[i];
    }
    if (branch) {
      const int* row = rows.data() + node.row_offset;
      for (int i = node.columns; i < node.rows; ++i, ++row) {
        Scalar* const to = *row < size ? x + 3 * static_cast<std::size_t>(*row)
                                       : lists.data() + 3 * static_cast<std::size_t>(*row - size);
        to[0] += px[i];
        to[1] += py[i];
        to[2] += pz[i];
      }
    } else {
      Scalar* to = own;
      for (int i = node.columns; i < node.rows; ++i, to += 3) {
        to[0] = px[i];
        to[1] = py[i];
        to[2] = pz[i];
      }
    }
  }
}

template <typename Scalar>
void SupernodalSolver<Scalar>::Inside::backward_task(const Task& task, Scalar* x, Scalar* v) {
  Scalar* own = lists.data() + 3 * static_cast<std::size_t>(task.list);
  for (int i = task.list; i < task.list + task.list_size; ++i, own += 3) {
    std::memcpy(own, x + 3 * static_cast<std::size_t>(list_rows[i]), 3 * sizeof(Scalar));
  }
  for (int s = task.last_node; s >= task.first_node; --s) {
    const Node& node = nodes[s];
    const int pad = pad_of(node);
    Scalar* const px = v;
    Scalar* const py = v + pad;
    Scalar* const pz = v + 2 * static_cast<std::size_t>(pad);
    Scalar* const mine = x + 3 * static_cast<std::size_t>(node.first_column);
    const Scalar* in = mine;
    for (int i = 0; i < node.columns; ++i, in += 3) {
      px[i] = in[0];
      py[i] = in[1];
      pz[i] = in[2];
    }
    const int* row = rows.data() + node.row_offset;
    for (int i = node.columns; i < node.rows; ++i, ++row) {
      const Scalar* const from = *row < size ? x + 3 * static_cast<std::size_t>(*row)
                                             : lists.data() + 3 * static_cast<std::size_t>(*row - size);
      px[i] = from[0];
      py[i] = from[1];
      pz[i] = from[2];
    }
    const std::size_t tail = sizeof(Scalar) * static_cast<std::size_t>(pad - node.rows);
    std::memset(px + node.rows, 0, tail);
    std::memset(py + node.rows, 0, tail);
    std::memset(pz + node.rows, 0, tail);
    kernels.backward(tiles.data() + node.tiles + tiles_of(node.columns, node.rows), node.columns, node.rows, v, pad);
    Scalar* out = mine;
    for (int i = 0; i < node.columns; ++i, out += 3) {
      out[0] = px[i];
      out[1] = py[i];
      out[2] = pz[i];
    }
  }
}

/// Forward, a task waits for its children, backward for its parent.
template <typename Scalar>
void SupernodalSolver<Scalar>::Inside::run_tasks(ThreadPool& pool, Scalar* x, bool forward) {
  const int count = static_cast<int>(tasks.size());
  if (pool.threads() == 1) {
    for (int t = 0; t < count; ++t) {
      if (forward) {
        forward_task(tasks[t], x, local[0].data());
      } else {
        backward_task(tasks[count - 1 - t], x, local[0].data());
      }
    }
    return;
  }
  for (int t = 0; t < count; ++t) {
    pending[t].store(forward ? tasks[t].children : 1, std::memory_order_relaxed);
    queue_ready[t].store(0, std::memory_order_relaxed);
  }
  const std::vector<int>& start = forward ? leaves : roots;
  for (std::size_t i = 0; i < start.size(); ++i) {
    queue[i] = start[i];
    queue_ready[i].store(1, std::memory_order_relaxed);
  }
  queue_head = 0;
  queue_tail = static_cast<int>(start.size());
  const auto push = [&](int task) {
    const int place = queue_tail++;
    queue[place] = task;
    queue_ready[place].store(1, std::memory_order_release);
  };
  pool.each(static_cast<int>(local.size()), [&](int worker) {
    Scalar* const v = local[worker].data();
    while (true) {
      const int place = queue_head++;
      if (place >= count) {
        return;
      }
      while (queue_ready[place].load(std::memory_order_acquire) == 0) {
        std::this_thread::yield();
      }
      const Task& task = tasks[queue[place]];
      if (forward) {
        forward_task(task, x, v);
        if (task.parent >= 0 && --pending[task.parent] == 0) {
          push(task.parent);
        }
      } else {
        backward_task(task, x, v);
        for (int c = task.first_child; c < task.last_child; ++c) {
          push(child_tasks[c]);
        }
      }
    }
  });
}

template <typename Scalar>
SupernodalSolver<Scalar>::SupernodalSolver(const SupernodalFactor& factor, ThreadPool& pool)
    : inside_(std::make_unique<Inside>()) {
  inside_->build(factor, pool);
}

template <typename Scalar>
SupernodalSolver<Scalar>::~SupernodalSolver() = default;

template <typename Scalar>
void SupernodalSolver<Scalar>::solve(Scalar* x, ThreadPool& pool) {
  inside_->run_tasks(pool, x, true);
  inside_->run_tasks(pool, x, false);
}

template <typename Scalar>
std::size_t SupernodalSolver<Scalar>::bytes() const {
  return inside_->tiles.size() * sizeof(Scalar) + inside_->rows.size() * sizeof(int);
}

template class SupernodalSolver<float>;
template class SupernodalSolver<double>;

}  // namespace lapedit
