// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/elimination_tree.h"

#include <algorithm>

#include "lapedit/linear/supernode_kernels.h"

namespace lapedit::supernode {

/// Of each supernode: its parent, and how much hangs on it.
struct EliminationTree::Branches {
  std::vector<int> parent, first;  // first supernode of the branch
  std::vector<double> work;        // of the branch
  double all = 0;
  bool postordered = true;  // branches are runs of consecutive supernodes

  Branches(const SupernodalFactor& factor, const EliminationTree& tree)
      : parent(factor.supernodes, -1), first(factor.supernodes), work(factor.supernodes) {
    const int count = factor.supernodes;
    std::vector<int> node_of_column(factor.size), branch_size(count, 1);
    for (int s = 0; s < count; ++s) {
      first[s] = s;
      std::fill(node_of_column.begin() + factor.columns[s], node_of_column.begin() + factor.columns[s + 1], s);
    }
    for (int s = 0; s < count; ++s) {
      const Node& node = tree.nodes[s];
      // What a supernode costs beyond reading it: gathering and scattering its rows.
      const double own = static_cast<double>(node.columns) * node.rows + 6.0 * node.rows;
      work[s] += own;
      all += own;
      postordered = postordered && branch_size[s] == s - first[s] + 1;
      if (node.rows > node.columns) {
        parent[s] = node_of_column[tree.rows[node.row_offset]];
        work[parent[s]] += work[s];
        first[parent[s]] = std::min(first[parent[s]], first[s]);
        branch_size[parent[s]] += branch_size[s];
      }
    }
  }

  bool small(int s) const {
    constexpr double kShare = 1.0 / 24;
    return postordered && work[s] <= kShare * all;
  }
};

EliminationTree::EliminationTree(const SupernodalFactor& factor)
    : size(factor.size),
      nodes(factor.supernodes),
      rows(factor.rows, factor.rows + factor.row_offsets[factor.supernodes]) {
  for (int s = 0; s < factor.supernodes; ++s) {
    Node& node = nodes[s];
    node.first_column = factor.columns[s];
    node.columns = factor.columns[s + 1] - factor.columns[s];
    node.rows = factor.row_offsets[s + 1] - factor.row_offsets[s];
    node.row_offset = factor.row_offsets[s] + node.columns;
    node.tiles = tiles;
    tiles += tiles_of(node.columns, node.rows);
    most_rows = std::max(most_rows, node.rows);
  }
  const Branches branches(factor, *this);
  cut(branches);
  join(branches);
  rename_rows();
}

/// Into branches of at most a share of all work, and supernodes above them.
void EliminationTree::cut(const Branches& branches) {
  for (int s = 0; s < static_cast<int>(nodes.size()); ++s) {
    const int parent = branches.parent[s];
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

/// Parents, children, and where a task's rows above it are in its parent.
void EliminationTree::join(const Branches& branches) {
  std::vector<int> task_of(nodes.size(), -1);
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    task_of[tasks[t].last_node] = static_cast<int>(t);
  }
  list_places.resize(list_rows.size());
  std::vector<std::vector<int>> children(tasks.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    Task& task = tasks[t];
    const int parent = branches.parent[task.last_node];
    if (parent < 0) {
      roots.push_back(static_cast<int>(t));
      continue;
    }
    task.parent = task_of[parent];
    children[task.parent].push_back(static_cast<int>(t));
    const Node& above = nodes[parent];
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
    tasks[t].first_child = static_cast<int>(child_tasks.size());
    child_tasks.insert(child_tasks.end(), children[t].begin(), children[t].end());
    tasks[t].last_child = static_cast<int>(child_tasks.size());
    if (children[t].empty()) {
      leaves.push_back(static_cast<int>(t));
    }
  }
}

/// Inside a branch, rows above it are named by their place in its list. Comes last, since join() reads rows of
/// supernodes that are tasks of their own, which stay.
void EliminationTree::rename_rows() {
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

}  // namespace lapedit::supernode
