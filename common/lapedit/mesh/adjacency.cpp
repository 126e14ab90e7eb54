// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/adjacency.h"

#include <algorithm>

namespace lapedit {
namespace {

/// Sorts each row and drops repeated entries, in place.
void sort_unique_rows(IndexLists& lists) {
  int written = 0;
  int first = 0;
  for (int row = 0; row < lists.rows(); ++row) {
    const int last = lists.offsets[row + 1];
    std::sort(lists.values.begin() + first, lists.values.begin() + last);
    const int start = written;
    for (int k = first; k < last; ++k) {
      if (written == start || lists.values[written - 1] != lists.values[k]) {
        lists.values[written++] = lists.values[k];
      }
    }
    first = last;
    lists.offsets[row + 1] = written;
  }
  lists.values.resize(written);
}

}  // namespace

Adjacency build_adjacency(int vertex_count, const Faces& faces) {
  Adjacency result;
  const int m = static_cast<int>(faces.rows());
  std::vector<int> corners(vertex_count, 0);
  for (int f = 0; f < m; ++f) {
    for (int k = 0; k < 3; ++k) {
      ++corners[faces(f, k)];
    }
  }
  IndexLists& around = result.faces;
  IndexLists& next = result.neighbours;
  around.offsets.assign(vertex_count + 1, 0);
  next.offsets.assign(vertex_count + 1, 0);
  for (int v = 0; v < vertex_count; ++v) {
    around.offsets[v + 1] = around.offsets[v] + corners[v];
    next.offsets[v + 1] = next.offsets[v] + 2 * corners[v];
  }
  around.values.resize(around.offsets.back());
  next.values.resize(next.offsets.back());
  std::vector<int> filled(vertex_count, 0);
  for (int f = 0; f < m; ++f) {
    for (int k = 0; k < 3; ++k) {
      const int v = faces(f, k);
      const int slot = filled[v]++;
      around.values[around.offsets[v] + slot] = f;
      next.values[next.offsets[v] + 2 * slot] = faces(f, (k + 1) % 3);
      next.values[next.offsets[v] + 2 * slot + 1] = faces(f, (k + 2) % 3);
    }
  }
  sort_unique_rows(around);
  sort_unique_rows(next);
  // A face that names a vertex twice makes it its own neighbour: take that out.
  int written = 0;
  int first = 0;
  for (int v = 0; v < vertex_count; ++v) {
    const int last = next.offsets[v + 1];
    for (int k = first; k < last; ++k) {
      if (next.values[k] != v) {
        next.values[written++] = next.values[k];
      }
    }
    first = last;
    next.offsets[v + 1] = written;
  }
  next.values.resize(written);
  return result;
}

int connected_components(const IndexLists& neighbours, std::vector<int>& labels) {
  const int n = neighbours.rows();
  labels.assign(n, -1);
  std::vector<int> stack;
  int count = 0;
  for (int seed = 0; seed < n; ++seed) {
    if (labels[seed] >= 0) {
      continue;
    }
    labels[seed] = count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const int v = stack.back();
      stack.pop_back();
      for (const int w : neighbours[v]) {
        if (labels[w] < 0) {
          labels[w] = count;
          stack.push_back(w);
        }
      }
    }
    ++count;
  }
  return count;
}

}  // namespace lapedit
