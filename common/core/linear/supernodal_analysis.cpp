// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/supernodal_analysis.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>
#include <numeric>
#include <utility>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/progress.h"

namespace lapedit {
namespace {

constexpr int kNone = -1;

/// The lower half of a matrix in a given order.
struct Neighbours {
  CompressedRows left, below;

  Neighbours(const SparseMatrix& matrix, const std::vector<int>& order) {
    const int n = static_cast<int>(matrix.cols());
    std::vector<int> position(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      position[order[k]] = static_cast<int>(k);
    }
    const auto for_each = [&](const auto& body) {
      Checkpoints checkpoints;
      for (int j = 0; j < n; ++j) {
        checkpoints();
        for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
          if (entry.row() > j) {
            const auto [low, high] = std::minmax(position[j], position[entry.row()]);
            body(low, high);
          }
        }
      }
    };
    left = lists_of(n, [&](const auto& use) { for_each([&](int low, int high) { use(high, low); }); });
    below = lists_of(n, for_each);
  }
};

/// Computes the parents of the elimination tree (Liu 1990): each column's first row below the diagonal of the factor.
std::vector<int> parents_of_columns(const CompressedRows& left, int n) {
  std::vector<int> parent(n, kNone), ancestor(n, kNone);
  Checkpoints checkpoints;
  for (int k = 0; k < n; ++k) {
    checkpoints();
    for (const int entry : left[k]) {
      for (int i = entry, next = kNone; i != kNone && i < k; i = next) {
        next = std::exchange(ancestor[i], k);
        if (next == kNone) {
          parent[i] = k;
        }
      }
    }
  }
  return parent;
}

/// Orders children before their parents and branches together; of several children the one with the largest weight
/// comes last.
std::vector<int> postorder(const std::vector<int>& parent, const std::vector<int>& weight) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> with_weight(n, kNone), next(n), first_child(n, kNone), sibling(n, kNone), order, path;
  for (int j = 0; j < n; ++j) {
    next[j] = std::exchange(with_weight[std::min(weight[j], n - 1)], j);
  }
  for (int w = n - 1; w >= 0; --w) {
    for (int j = with_weight[w]; j != kNone; j = next[j]) {
      if (parent[j] != kNone) {
        sibling[j] = std::exchange(first_child[parent[j]], j);
      }
    }
  }
  order.reserve(n);
  for (int root = 0; root < n; ++root) {
    if (parent[root] != kNone) {
      continue;
    }
    path.push_back(root);
    while (!path.empty()) {
      const int j = path.back();
      if (const int child = first_child[j]; child != kNone) {
        first_child[j] = sibling[child];
        path.push_back(child);
      } else {
        order.push_back(j);
        path.pop_back();
      }
    }
  }
  return order;
}

/// Counts the entries of each column of the factor, including the diagonal (Gilbert, Ng and Peyton 1994): the leaves of
/// each row's subtree of the elimination tree, minus the positions where their paths meet.
std::vector<int> column_counts(const CompressedRows& below, const std::vector<int>& parent,
                               const std::vector<int>& post) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> count(n), first(n, kNone), most_first(n, kNone), last_leaf(n, kNone), ancestor(n);
  std::iota(ancestor.begin(), ancestor.end(), 0);
  for (int k = 0; k < n; ++k) {
    int j = post[k];
    count[j] = first[j] == kNone ? 1 : 0;
    for (; j != kNone && first[j] == kNone; j = parent[j]) {
      first[j] = k;
    }
  }
  Checkpoints checkpoints;
  for (const int j : post) {
    checkpoints();
    if (parent[j] != kNone) {
      --count[parent[j]];
    }
    for (const int row : below[j]) {
      if (first[j] <= most_first[row]) {
        continue;  // not a leaf of the row's subtree
      }
      most_first[row] = first[j];
      ++count[j];
      const int before = std::exchange(last_leaf[row], j);
      if (before == kNone) {
        continue;
      }
      int meeting = before;
      while (meeting != ancestor[meeting]) {
        meeting = ancestor[meeting];
      }
      for (int s = before; s != meeting;) {
        s = std::exchange(ancestor[s], meeting);
      }
      --count[meeting];
    }
    if (parent[j] != kNone) {
      ancestor[j] = parent[j];
    }
  }
  for (int j = 0; j < n; ++j) {
    if (parent[j] != kNone) {
      count[parent[j]] += count[j];
    }
  }
  return count;
}

/// Returns the first columns of supernodes, followed by the number of columns. Columns that form a chain with the same
/// rows make a supernode.
std::vector<int> fundamental_supernodes(const std::vector<int>& parent, const std::vector<int>& count) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> children(n, 0), columns{0};
  for (int j = 0; j < n; ++j) {
    if (parent[j] != kNone) {
      ++children[parent[j]];
    }
  }
  for (int j = 1; j < n; ++j) {
    if (parent[j - 1] != j || count[j - 1] != count[j] + 1 || children[j] > 1) {
      columns.push_back(j);
    }
  }
  if (n > 0) {
    columns.push_back(n);
  }
  return columns;
}

std::vector<int> supernode_of_columns(const std::vector<int>& columns) {
  std::vector<int> of(columns.back());
  for (std::size_t s = 0; s + 1 < columns.size(); ++s) {
    std::fill(of.begin() + columns[s], of.begin() + columns[s + 1], static_cast<int>(s));
  }
  return of;
}

std::vector<int> parents_of_supernodes(const std::vector<int>& columns, const std::vector<int>& of,
                                       const std::vector<int>& parent) {
  std::vector<int> above(columns.size() - 1);
  for (std::size_t s = 0; s < above.size(); ++s) {
    const int next = parent[columns[s + 1] - 1];
    above[s] = next == kNone ? kNone : of[next];
  }
  return above;
}

/// A supernode before its parent, and the two joined.
struct Joined {
  int columns = 0, rows = 0;
  double zeros = 0;
};

/// Applies CHOLMOD's rule for relaxed supernodes (Chen, Davis, Hager and Rajamanickam 2008). @return whether lower and
/// upper should be joined; lower is the result then
bool join(Joined& lower, const Joined& upper) {
  const int columns = lower.columns + upper.columns;
  double zeros = upper.zeros;
  constexpr int kAlways = 4, kOften = 16, kSeldom = 48;
  if (columns > kAlways) {
    const double added = static_cast<double>(lower.columns) * (upper.rows + lower.columns - lower.rows);
    if (added > 0) {
      const double size = 0.5 * columns * (columns + 1.0) + static_cast<double>(columns) * (upper.rows - upper.columns);
      const double fraction = (zeros + added) / size;
      constexpr double kMostOften = 0.8, kMostSeldom = 0.1, kMostLarge = 0.05;
      if (!((columns <= kOften && fraction < kMostOften) || (columns <= kSeldom && fraction < kMostSeldom) ||
            fraction < kMostLarge) ||
          size >= std::numeric_limits<int>::max() / static_cast<double>(sizeof(double))) {
        return false;
      }
      zeros += added;
    }
  }
  lower = {columns, lower.columns + upper.rows, zeros};
  return true;
}

/// Joins supernodes with their parents if these follow directly. Fills columns and row_offsets.
void join_supernodes(const std::vector<int>& fundamental, const std::vector<int>& parent, const std::vector<int>& count,
                     SupernodalPattern& pattern) {
  const int supernodes = static_cast<int>(fundamental.size()) - 1;
  const std::vector<int> of = supernode_of_columns(fundamental);
  const std::vector<int> above = parents_of_supernodes(fundamental, of, parent);
  std::vector<Joined> nodes(supernodes);
  std::vector<int> into(supernodes, kNone);
  for (int s = 0; s < supernodes; ++s) {
    nodes[s] = {fundamental[s + 1] - fundamental[s], count[fundamental[s]], 0};
  }
  for (int s = supernodes - 2; s >= 0; --s) {
    int now = above[s];
    while (now != kNone && into[now] != kNone) {
      now = into[now];
    }
    for (int t = above[s]; t != kNone && into[t] != kNone;) {
      t = std::exchange(into[t], now);
    }
    if (now == s + 1 && join(nodes[s], nodes[s + 1])) {
      into[s + 1] = s;
    }
  }
  std::int64_t rows = 0;
  pattern.row_offsets = {0};
  for (int s = 0; s < supernodes; ++s) {
    if (into[s] == kNone) {
      rows += nodes[s].rows;
      if (rows > std::numeric_limits<int>::max()) {
        throw std::bad_alloc();
      }
      pattern.columns.push_back(fundamental[s]);
      pattern.row_offsets.push_back(static_cast<int>(rows));
    }
  }
  pattern.columns.push_back(fundamental.back());
}

/// Lists the rows of each supernode. Row k is in all supernodes on the paths from its entries up the tree to its own.
void fill_rows(const CompressedRows& left, const std::vector<int>& post, const std::vector<int>& position,
               const std::vector<int>& parent, SupernodalPattern& pattern) {
  const std::vector<int> of = supernode_of_columns(pattern.columns);
  const std::vector<int> above = parents_of_supernodes(pattern.columns, of, parent);
  std::vector<int> next(pattern.row_offsets.begin(), pattern.row_offsets.end() - 1), seen(above.size(), kNone);
  pattern.rows.resize(pattern.row_offsets.back());
  const int n = static_cast<int>(post.size());
  Checkpoints checkpoints;
  for (int k = 0; k < n; ++k) {
    checkpoints();
    seen[of[k]] = k;
    pattern.rows[next[of[k]]++] = k;
    for (const int entry : left[post[k]]) {
      for (int s = of[position[entry]]; seen[s] != k; s = above[s]) {
        seen[s] = k;
        pattern.rows[next[s]++] = k;
      }
    }
  }
}

}  // namespace

std::vector<int> minimum_degree(const SparseMatrix& matrix) {
  const SparseMatrix whole = matrix.selfadjointView<Eigen::Lower>();
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(whole, permutation);
  return {permutation.indices().data(), permutation.indices().data() + permutation.size()};
}

SupernodalPattern supernodal_analysis(const SparseMatrix& matrix, const std::vector<int>& order) {
  const std::vector<int> given = order.empty() ? minimum_degree(matrix) : order;
  const int n = static_cast<int>(given.size());
  const Neighbours neighbours(matrix, given);
  const std::vector<int> parent = parents_of_columns(neighbours.left, n);
  const std::vector<int> count = column_counts(neighbours.below, parent, postorder(parent, std::vector<int>(n, 0)));
  const std::vector<int> post = postorder(parent, count);
  // Renumbers parents and counts by the postorder.
  SupernodalPattern pattern;
  pattern.order.resize(n);
  std::vector<int> position(n), placed_parent(n), placed_count(n);
  for (int k = 0; k < n; ++k) {
    position[post[k]] = k;
    pattern.order[k] = given[post[k]];
  }
  for (int k = 0; k < n; ++k) {
    placed_parent[k] = parent[post[k]] == kNone ? kNone : position[parent[post[k]]];
    placed_count[k] = count[post[k]];
  }
  join_supernodes(fundamental_supernodes(placed_parent, placed_count), placed_parent, placed_count, pattern);
  fill_rows(neighbours.left, post, position, placed_parent, pattern);
  return pattern;
}

}  // namespace lapedit
