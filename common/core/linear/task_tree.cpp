// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/task_tree.h"

#include <algorithm>
#include <numeric>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/linear/supernode_kernels.h"

namespace lapedit::supernode {

/// The work below each supernode.
struct TaskTree::Branches {
  std::vector<int> first;    // first supernode of the branch
  std::vector<double> work;  // of the branch
  double all = 0;
  bool postordered = true;  // branches are runs of consecutive supernodes

  explicit Branches(const std::vector<Node>& nodes) : first(nodes.size()), work(nodes.size()) {
    const int count = static_cast<int>(nodes.size());
    std::vector<int> branch_size(count, 1);
    std::iota(first.begin(), first.end(), 0);
    for (int s = 0; s < count; ++s) {
      const Node& node = nodes[s];
      // Cost of a supernode in addition to reading it: gathering and scattering its rows.
      const double own = static_cast<double>(node.columns) * node.rows + 6.0 * node.rows;
      work[s] += own;
      all += own;
      postordered = postordered && branch_size[s] == s - first[s] + 1;
      if (node.parent >= 0) {
        work[node.parent] += work[s];
        first[node.parent] = std::min(first[node.parent], first[s]);
        branch_size[node.parent] += branch_size[s];
      }
    }
  }

  bool small(int s) const {
    constexpr double kShare = 1.0 / 24;
    return postordered && work[s] <= kShare * all;
  }
};

TaskTree::TaskTree(const SupernodalPattern& pattern)
    : size(pattern.size()), nodes(pattern.supernodes()), rows(pattern.rows) {
  std::vector<int> node_of_column(size);
  for (int s = 0; s < pattern.supernodes(); ++s) {
    Node& node = nodes[s];
    node.first_column = pattern.columns[s];
    node.columns = pattern.columns_of(s);
    node.rows = pattern.rows_of(s);
    node.row_offset = pattern.row_offsets[s] + node.columns;
    node.tiles = tiles;
    tiles += tiles_of(node.columns, node.rows);
    most_rows = std::max(most_rows, node.rows);
    std::fill_n(node_of_column.begin() + node.first_column, node.columns, s);
  }
  for (Node& node : nodes) {
    node.parent = node.rows > node.columns ? node_of_column[rows[node.row_offset]] : -1;
  }
  cut(Branches(nodes));
  join();
  rename_rows();
}

/// Divides the tree into branches of at most a fraction of all work, and supernodes above them.
void TaskTree::cut(const Branches& branches) {
  for (int s = 0; s < static_cast<int>(nodes.size()); ++s) {
    const int parent = nodes[s].parent;
    const bool small = branches.small(s);
    if (small && parent >= 0 && branches.small(parent)) {
      continue;  // inside a branch
    }
    Task task{};
    task.first_node = small ? branches.first[s] : s;
    task.last_node = s;
    task.parent = -1;
    task.list = static_cast<int>(list_rows.size());
    task.list_size = nodes[s].rows - nodes[s].columns;
    list_rows.insert(list_rows.end(), rows.begin() + nodes[s].row_offset,
                     rows.begin() + nodes[s].row_offset + task.list_size);
    tasks.push_back(task);
  }
}

/// Computes the parents and children of tasks, and the positions in the parent of a task's rows above it.
void TaskTree::join() {
  std::vector<int> task_of(nodes.size(), -1);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    task_of[tasks[t].last_node] = static_cast<int>(t);
  }
  list_places.resize(list_rows.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    Task& task = tasks[t];
    const int parent = nodes[task.last_node].parent;
    if (parent < 0) {
      roots.push_back(static_cast<int>(t));
      continue;
    }
    task.parent = task_of[parent];
    const Node& above = nodes[parent];
    int position = 0;
    for (int i = task.list; i < task.list + task.list_size; ++i) {
      if (list_rows[i] < above.first_column + above.columns) {
        list_places[i] = list_rows[i] - above.first_column;
        continue;
      }
      while (rows[above.row_offset + position] != list_rows[i]) {
        ++position;
      }
      list_places[i] = above.columns + position;
    }
  }
  const CompressedRows children = lists_of(static_cast<int>(tasks.size()), [this](const auto& use) {
    for (int t = 0; t < static_cast<int>(tasks.size()); ++t) {
      if (tasks[t].parent >= 0) {
        use(tasks[t].parent, t);
      }
    }
  });
  child_tasks = children.values;
  for (int t = 0; t < children.rows(); ++t) {
    tasks[t].first_child = children.offsets[t];
    tasks[t].last_child = children.offsets[t + 1];
    if (children[t].size() == 0) {
      leaves.push_back(t);
    }
  }
}

/// Replaces, inside each branch, the rows above it by their indices in its list. This function must run last, since
/// join() reads the rows of supernodes that are tasks of their own, which do not change.
void TaskTree::rename_rows() {
  for (const Task& task : tasks) {
    const int end = nodes[task.last_node].first_column + nodes[task.last_node].columns;
    const int* const list_begin = list_rows.data() + task.list;
    for (int s = task.first_node; task.first_node < task.last_node && s <= task.last_node; ++s) {
      int position = 0;
      for (int i = nodes[s].row_offset; i < nodes[s].row_offset + nodes[s].rows - nodes[s].columns; ++i) {
        if (rows[i] >= end) {
          while (list_begin[position] != rows[i]) {
            ++position;
          }
          rows[i] = size + task.list + position;
        }
      }
    }
  }
}

}  // namespace lapedit::supernode
