// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/fill_reducing_ordering.h"

#include <algorithm>

#include "lapedit/linear/nested_dissection.h"

namespace lapedit {
namespace {

/// Numbers of edges from a vertex, and from the lowest unreached one on where that leads nowhere any more.
/// @return the last vertex reached
int count_edges(const IndexLists& neighbours, int from, std::vector<int>& count, std::vector<int>& queue) {
  count.assign(neighbours.rows(), -1);
  queue.assign(1, from);
  count[from] = 0;
  int next_seed = 0;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const int v = queue[head];
    for (const int w : neighbours[v]) {
      if (count[w] < 0) {
        count[w] = count[v] + 1;
        queue.push_back(w);
      }
    }
    while (head + 1 == queue.size() && next_seed < neighbours.rows()) {
      if (count[next_seed] < 0) {
        count[next_seed] = count[v] + 1;
        queue.push_back(next_seed);
      }
      ++next_seed;
    }
  }
  return queue.back();
}

}  // namespace

std::vector<int> fill_reducing_ordering(const IndexLists& neighbours, int threads) {
  constexpr int kWorthwhile = 20000;  // measured with tests/scripts/speed.sh
  const int n = neighbours.rows();
  if (n < kWorthwhile) {
    return {};
  }
  std::vector<int> first, second, third, queue;
  const int a = count_edges(neighbours, 0, first, queue);
  const int b = count_edges(neighbours, a, first, queue);
  count_edges(neighbours, b, second, queue);
  int c = 0;
  for (int v = 0; v < n; ++v) {
    if (std::min(first[v], second[v]) > std::min(first[c], second[c])) {
      c = v;
    }
  }
  count_edges(neighbours, c, third, queue);
  Points coordinates(n, 3);
  for (int v = 0; v < n; ++v) {
    coordinates.row(v) << first[v], second[v], third[v];
  }
  return nested_dissection(neighbours, coordinates, threads);
}

}  // namespace lapedit
