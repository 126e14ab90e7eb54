// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "lapedit/linear/supernodal_analysis.h"

namespace lapedit::supernode {

/// The elimination tree of a supernodal factor, divided into tasks for several threads. Each small branch is one task,
/// and each supernode above the branches is one task. A task collects its sums for rows above it in a list, which its
/// parent adds in the order of its children, so sums do not depend on the number of threads.
struct TaskTree {
  struct Node {  ///< a supernode
    int first_column, columns, rows;
    int parent;         ///< -1: a root
    int row_offset;     ///< of its rows below its own columns, in `rows`
    std::size_t tiles;  ///< offset of its values
  };
  struct Task {
    int first_node, last_node;  ///< a branch, or one supernode
    int parent;                 ///< -1: a root
    int first_child, last_child;
    int list;  ///< its rows above it: offset in list_rows, and in the lists of a solve
    int list_size;

    int children() const { return last_child - first_child; }
  };

  int size = 0, most_rows = 0;
  std::size_t tiles = 0;  ///< values of all supernodes
  std::vector<Node> nodes;
  std::vector<int> rows;  ///< below a supernode: a row of x, or size + a position in the branch's list
  std::vector<Task> tasks;
  std::vector<int> list_rows;      ///< rows of x
  std::vector<int> list_places;    ///< the same for the parent: its local row
  std::vector<int> child_tasks;    ///< by parent
  std::vector<int> leaves, roots;  ///< tasks

  /// O(rows of the factor).
  explicit TaskTree(const SupernodalPattern& pattern);

 private:
  struct Branches;
  void cut(const Branches& branches);
  void join();
  void rename_rows();
};

}  // namespace lapedit::supernode
