// SPDX-License-Identifier: GPL-3.0-or-later
//
// Layout. A supernode's columns are cut into blocks of kWide. A block holds the inverse of its triangle and, below it,
// panels of kTall rows, each column by column. Both passes then read the factor from one end to the other: forward, the
// lanes of a vector are rows of a panel and y of the block's columns is broadcast; backward, the block's sums stay in
// registers while its panels go by.
//
// Tree. Small branches of the elimination tree are one task each; every supernode above them is a task of its own. A
// task adds what it has for rows above it into a list of its own, which its parent takes over in the order of its
// children.
#include "lapedit/supernodal_solve.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

#include "lapedit/instructions.h"

namespace lapedit {
namespace {

constexpr int kWide = 8;  // columns of a block
constexpr int kTall = 8;  // rows of a panel

template <typename Scalar>
struct Lanes {
  typedef Scalar Vector __attribute__((vector_size(kTall * sizeof(Scalar))));
};

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

// --- Kernels --------------------------------------------------------------------------------------------------------
// Local vectors: three arrays (x, y, z) of padded_rows each, zero beyond the rows.

constexpr int kAhead = 512;  // bytes that the kernels ask for in advance: the hardware stops at small pages

template <typename Scalar>
LAPEDIT_INLINE void fetch(const Scalar* place) {
  __builtin_prefetch(reinterpret_cast<const char*>(place) + kAhead);
}

/// Sums over the lanes of eight vectors, one per lane.
template <typename Vector>
LAPEDIT_INLINE Vector lane_sums(const Vector* s) {
  Vector t[4], u[2];
#pragma GCC unroll 4
  for (std::ptrdiff_t k = 0; k < 4; ++k) {
    t[k] = __builtin_shufflevector(s[2 * k], s[2 * k + 1], 0, 8, 2, 10, 4, 12, 6, 14) +
           __builtin_shufflevector(s[2 * k], s[2 * k + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
#pragma GCC unroll 2
  for (std::ptrdiff_t k = 0; k < 2; ++k) {
    u[k] = __builtin_shufflevector(t[2 * k], t[2 * k + 1], 0, 1, 8, 9, 4, 5, 12, 13) +
           __builtin_shufflevector(t[2 * k], t[2 * k + 1], 2, 3, 10, 11, 6, 7, 14, 15);
  }
  return __builtin_shufflevector(u[0], u[1], 0, 1, 2, 3, 8, 9, 10, 11) +
         __builtin_shufflevector(u[0], u[1], 4, 5, 6, 7, 12, 13, 14, 15);
}

template <typename Vector, typename Scalar>
LAPEDIT_INLINE Vector load(const Scalar* place) {
  Vector result;
  std::memcpy(&result, place, sizeof result);
  return result;
}

// Loops over lanes, columns and right-hand sides have to be unrolled for their sums to stay in registers.

/// One block forward: y = T^-1 v, then v below -= L y. @return behind the block
template <typename Scalar, int Width>
LAPEDIT_INLINE const Scalar* forward_block(const Scalar* block, int panels, Scalar* v, int pad) {
  using Vector = typename Lanes<Scalar>::Vector;
  Scalar y[3][kWide];
  Vector start[3] = {};
#pragma GCC unroll 8
  for (int j = 0; j < Width; ++j) {
    const Vector column = load<Vector>(block + j * kWide);
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
      start[r] += column * v[r * pad + j];
    }
  }
#pragma GCC unroll 3
  for (int r = 0; r < 3; ++r) {
    std::memcpy(y[r], &start[r], sizeof start[r]);
    std::memcpy(v + r * pad, y[r], Width * sizeof(Scalar));
  }
  const Scalar* tile = block + Width * kWide;
  Scalar* below = v + Width;
  for (int p = 0; p < panels; ++p) {
    Vector sum[3];
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
      sum[r] = load<Vector>(below + r * pad);
    }
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      const Vector column = load<Vector>(tile + j * kTall);
      fetch(tile + j * kTall);
#pragma GCC unroll 3
      for (int r = 0; r < 3; ++r) {
        sum[r] -= column * y[r][j];
      }
    }
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
      std::memcpy(below + r * pad, &sum[r], sizeof sum[r]);
    }
    tile += Width * kTall;
    below += kTall;
  }
  return tile;
}

/// Sums of a panel's column times the rows below, for Count columns of a block from `first` on.
template <typename Scalar, int Width, int Count>
LAPEDIT_INLINE void backward_sums(const Scalar* tile, int panels, const Scalar* below, int pad,
                                  typename Lanes<Scalar>::Vector (*sums)[kWide]) {
  using Vector = typename Lanes<Scalar>::Vector;
  Vector sum[3][Count] = {};
  for (int p = 0; p < panels; ++p) {
    Vector x[3];
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
      x[r] = load<Vector>(below + r * pad);
    }
#pragma GCC unroll 8
    for (int j = 0; j < Count; ++j) {
      const Vector column = load<Vector>(tile + j * kTall);
      fetch(tile + j * kTall);
#pragma GCC unroll 3
      for (int r = 0; r < 3; ++r) {
        sum[r][j] += column * x[r];
      }
    }
    tile += Width * kTall;
    below += kTall;
  }
#pragma GCC unroll 3
  for (int r = 0; r < 3; ++r) {
#pragma GCC unroll 8
    for (int j = 0; j < Count; ++j) {
      sums[r][j] = sum[r][j];
    }
  }
}

/// One block backward: v of the block = T^-T (v - L^T v below). Group columns at a time, as registers allow.
template <typename Scalar, int Width, int Group>
LAPEDIT_INLINE void backward_block(const Scalar* block, int panels, Scalar* v, int pad) {
  using Vector = typename Lanes<Scalar>::Vector;
  Vector sums[3][kWide] = {};
  constexpr int kWhole = Width / Group * Group;
  const Scalar* const tiles = block + Width * kWide;
#pragma GCC unroll 8
  for (int first = 0; first < kWhole; first += Group) {
    Vector part[3][kWide];
    backward_sums<Scalar, Width, Group>(tiles + first * kTall, panels, v + Width, pad, part);
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
#pragma GCC unroll 8
      for (int j = 0; j < Group; ++j) {
        sums[r][first + j] = part[r][j];
      }
    }
  }
  if constexpr (kWhole < Width) {
    Vector part[3][kWide];
    backward_sums<Scalar, Width, Width - kWhole>(tiles + kWhole * kTall, panels, v + Width, pad, part);
#pragma GCC unroll 3
    for (int r = 0; r < 3; ++r) {
#pragma GCC unroll 8
      for (int j = kWhole; j < Width; ++j) {
        sums[r][j] = part[r][j - kWhole];
      }
    }
  }
#pragma GCC unroll 3
  for (int r = 0; r < 3; ++r) {
    // Lanes beyond Width are rows below, and meet zeros of the triangle.
    const Vector y = load<Vector>(v + r * pad) - lane_sums(sums[r]);
    Vector products[kWide] = {};
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j) {
      products[j] = load<Vector>(block + j * kWide) * y;
    }
    const Vector result = lane_sums(products);
    std::memcpy(v + r * pad, &result, Width * sizeof(Scalar));
  }
}

template <typename Scalar>
struct Kernels {
  /// All blocks of a supernode. @param v  its local vectors
  void (*forward)(const Scalar* tiles, int columns, int rows, Scalar* v, int pad);
  /// @param end  behind the supernode's tiles
  void (*backward)(const Scalar* tiles, int columns, int rows, Scalar* v, int pad);
};

constexpr int panels_below(int rows_below) {
  return (rows_below + kTall - 1) / kTall;
}

template <int Width>
struct WidthTag {
  static constexpr int kWidth = Width;
};

template <class Function>
LAPEDIT_INLINE void with_width(int width, const Function& function) {
  switch (width) {
    case 1:
      function(WidthTag<1>());
      break;
    case 2:
      function(WidthTag<2>());
      break;
    case 3:
      function(WidthTag<3>());
      break;
    case 4:
      function(WidthTag<4>());
      break;
    case 5:
      function(WidthTag<5>());
      break;
    case 6:
      function(WidthTag<6>());
      break;
    case 7:
      function(WidthTag<7>());
      break;
    default:
      function(WidthTag<8>());
      break;
  }
}

template <typename Scalar>
LAPEDIT_INLINE void forward_supernode(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  int first = 0;
  for (; first + kWide <= columns; first += kWide) {
    tiles = forward_block<Scalar, kWide>(tiles, panels_below(rows - first - kWide), v + first, pad);
  }
  if (first < columns) {
    with_width(
        columns - first, [&](auto tag) __attribute__((always_inline)) {
          forward_block<Scalar, decltype(tag)::kWidth>(tiles, panels_below(rows - columns), v + first, pad);
        });
  }
}

/// Values of one block's tiles.
constexpr std::size_t block_size(int width, int rows_below) {
  return static_cast<std::size_t>(width) * (kWide + kTall * static_cast<std::size_t>(panels_below(rows_below)));
}

template <typename Scalar, int Group>
LAPEDIT_INLINE void backward_supernode(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  const int rest = columns % kWide;
  int first = columns - rest;
  if (rest > 0) {
    end -= block_size(rest, rows - columns);
    with_width(
        rest, [&](auto tag) __attribute__((always_inline)) {
          backward_block<Scalar, decltype(tag)::kWidth, Group>(end, panels_below(rows - columns), v + first, pad);
        });
  }
  while (first > 0) {
    first -= kWide;
    const int below = rows - first - kWide;
    end -= block_size(kWide, below);
    backward_block<Scalar, kWide, Group>(end, panels_below(below), v + first, pad);
  }
}

template <typename Scalar>
void forward_plain(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  forward_supernode(tiles, columns, rows, v, pad);
}
template <typename Scalar>
void backward_plain(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  backward_supernode<Scalar, 2>(end, columns, rows, v, pad);
}

#ifdef LAPEDIT_HAVE_AVX
template <typename Scalar>
LAPEDIT_AVX2 void forward_avx2(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  forward_supernode(tiles, columns, rows, v, pad);
}
template <typename Scalar>
LAPEDIT_AVX2 void backward_avx2(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  backward_supernode<Scalar, sizeof(Scalar) == 8 ? 2 : 4>(end, columns, rows, v, pad);
}
template <typename Scalar>
LAPEDIT_AVX512 void forward_avx512(const Scalar* tiles, int columns, int rows, Scalar* v, int pad) {
  forward_supernode(tiles, columns, rows, v, pad);
}
template <typename Scalar>
LAPEDIT_AVX512 void backward_avx512(const Scalar* end, int columns, int rows, Scalar* v, int pad) {
  backward_supernode<Scalar, 8>(end, columns, rows, v, pad);
}
#endif

template <typename Scalar>
Kernels<Scalar> best_kernels() {
#ifdef LAPEDIT_HAVE_AVX
  switch (best_instructions()) {
    case Instructions::Avx512:
      return {forward_avx512<Scalar>, backward_avx512<Scalar>};
    case Instructions::Avx2:
      return {forward_avx2<Scalar>, backward_avx2<Scalar>};
    default:
      break;
  }
#endif
  return {forward_plain<Scalar>, backward_plain<Scalar>};
}

/// What single precision would hold as a denormal number, slow to work with, is far below its rounding.
template <typename Scalar>
Scalar stored(double value) {
  constexpr double kNothing = sizeof(Scalar) < sizeof(double) ? 1e-25 : 0;
  return std::abs(value) > kNothing ? static_cast<Scalar>(value) : Scalar(0);
}

/// Copies a supernode's values into tiles and inverts the triangles. @return behind what was written
template <typename Scalar>
Scalar* write_tiles(const double* values, int columns, int rows, Scalar* out) {
  for (int first = 0; first < columns; first += kWide) {
    const int width = std::min(kWide, columns - first);
    double inverse[kWide][kWide] = {};  // [column][row]
    for (int j = 0; j < width; ++j) {
      inverse[j][j] = 1 / values[static_cast<std::size_t>(first + j) * rows + first + j];
      for (int i = j + 1; i < width; ++i) {
        double sum = 0;
        for (int k = j; k < i; ++k) {
          sum += values[static_cast<std::size_t>(first + k) * rows + first + i] * inverse[j][k];
        }
        inverse[j][i] = -sum / values[static_cast<std::size_t>(first + i) * rows + first + i];
      }
    }
    for (int j = 0; j < width; ++j) {
      for (int i = 0; i < kWide; ++i) {
        *out++ = stored<Scalar>(inverse[j][i]);
      }
    }
    for (int row = first + width; row < rows; row += kTall) {
      const int tall = std::min(kTall, rows - row);
      for (int j = 0; j < width; ++j) {
        const double* column = values + static_cast<std::size_t>(first + j) * rows + row;
        for (int i = 0; i < tall; ++i) {
          out[i] = stored<Scalar>(column[i]);
        }
        for (int i = tall; i < kTall; ++i) {
          out[i] = 0;
        }
        out += kTall;
      }
    }
  }
  return out;
}

std::size_t tiles_of(int columns, int rows) {
  std::size_t size = 0;
  for (int first = 0; first < columns; first += kWide) {
    const int width = std::min(kWide, columns - first);
    size += block_size(width, rows - first - width);
  }
  return size;
}

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

  void build(const SupernodalFactor& factor, Crew& crew);
  void make_tasks(const SupernodalFactor& factor);
  void run_tasks(Crew& crew, Scalar* x, bool forward);
  void forward_task(const Task& task, Scalar* x, Scalar* v);
  void backward_task(const Task& task, Scalar* x, Scalar* v);
  int pad_of(const Node& node) const { return node.rows + kWide + kTall; }
};

template <typename Scalar>
void SupernodalSolver<Scalar>::Inside::build(const SupernodalFactor& factor, Crew& crew) {
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
  in_pieces(crew, factor.supernodes, kGrain, [&](int first, int last) {
    for (int s = first; s < last; ++s) {
      write_tiles(factor.values + factor.value_offsets[s], nodes[s].columns, nodes[s].rows,
                  tiles.data() + nodes[s].tiles);
    }
  });
  make_tasks(factor);
  local.resize(crew.threads());
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
void SupernodalSolver<Scalar>::Inside::run_tasks(Crew& crew, Scalar* x, bool forward) {
  const int count = static_cast<int>(tasks.size());
  if (crew.threads() == 1) {
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
  crew.each(static_cast<int>(local.size()), [&](int worker) {
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
SupernodalSolver<Scalar>::SupernodalSolver(const SupernodalFactor& factor, Crew& crew)
    : inside_(std::make_unique<Inside>()) {
  inside_->build(factor, crew);
}

template <typename Scalar>
SupernodalSolver<Scalar>::~SupernodalSolver() = default;

template <typename Scalar>
void SupernodalSolver<Scalar>::solve(Scalar* x, Crew& crew) {
  inside_->run_tasks(crew, x, true);
  inside_->run_tasks(crew, x, false);
}

template <typename Scalar>
std::size_t SupernodalSolver<Scalar>::bytes() const {
  return inside_->tiles.size() * sizeof(Scalar) + inside_->rows.size() * sizeof(int);
}

template class SupernodalSolver<float>;
template class SupernodalSolver<double>;

}  // namespace lapedit
