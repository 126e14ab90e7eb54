// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/patch_border.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "lapedit/base/progress.h"

namespace lapedit {

using Edge = std::pair<unsigned, unsigned>;

std::vector<Edge> single_edges(const std::vector<unsigned>& corners) {
  // Lists the larger ends of edges by their smaller ends.
  const auto each_edge = [&corners](const auto& call) {
    Checkpoints checkpoints;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      checkpoints();
      const unsigned a = corners[i], b = corners[i % 3 == 2 ? i - 2 : i + 1];
      if (a != b) {
        call(std::min(a, b), std::max(a, b));
      }
    }
  };
  const std::size_t n = corners.empty() ? 0 : *std::max_element(corners.begin(), corners.end()) + std::size_t{1};
  std::vector<unsigned> end(n + 1, 0);
  each_edge([&](unsigned a, unsigned) { ++end[a + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<unsigned> larger(end.back());
  each_edge([&](unsigned a, unsigned b) { larger[end[a]++] = b; });
  std::vector<Edge> edges;
  Checkpoints checkpoints;
  for (std::size_t a = 0, first = 0; a < n; first = end[a++]) {
    checkpoints();
    std::sort(larger.begin() + static_cast<std::ptrdiff_t>(first), larger.begin() + end[a]);
    for (std::size_t i = first; i < end[a]; ++i) {
      if ((i == first || larger[i - 1] != larger[i]) && (i + 1 == end[a] || larger[i + 1] != larger[i])) {
        edges.emplace_back(static_cast<unsigned>(a), larger[i]);
      }
    }
  }
  return edges;
}

Chains border_of(const std::vector<unsigned>& corners) {
  const std::vector<Edge> edges = single_edges(corners);
  // Lists each edge from both ends, to find the next edge at a vertex.
  std::vector<std::pair<unsigned, std::size_t>> from;
  from.reserve(2 * edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    from.emplace_back(edges[e].first, e);
    from.emplace_back(edges[e].second, e);
  }
  std::sort(from.begin(), from.end());
  std::vector<char> used(edges.size(), 0);
  Chains chains;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (used[e]) {
      continue;
    }
    const std::size_t first = chains.vertices.size();
    unsigned at = edges[e].first;
    chains.vertices.push_back(at);
    for (std::size_t next = e; next < edges.size();) {
      used[next] = 1;
      at = edges[next].first == at ? edges[next].second : edges[next].first;
      chains.vertices.push_back(at);
      next = edges.size();
      for (auto edge = std::lower_bound(from.begin(), from.end(), std::make_pair(at, std::size_t{0}));
           edge != from.end() && edge->first == at && next == edges.size(); ++edge) {
        next = used[edge->second] ? next : edge->second;
      }
    }
    chains.lengths.push_back(static_cast<int>(chains.vertices.size() - first));
  }
  return chains;
}

}  // namespace lapedit
