// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "lapedit/mesh/adjacency.h"

namespace lapedit {

constexpr double kUnreached = std::numeric_limits<double>::infinity();

/// Shortest paths along mesh edges (Dijkstra, edge weight = edge length): the distance of Lipman et al. 2004,
/// section 6.
///
/// One object serves many searches: its arrays are sized once, and a search costs O(k log k) in the number k of
/// vertices it reaches, not in the size of the graph. Edges to a vertex with a non-finite coordinate are not followed.
class GeodesicSearch {
 public:
  /// Both arguments must outlive the object; row i of points is vertex i of the graph.
  GeodesicSearch(const IndexLists& neighbours, const Points& points);

  /// Distances (model units) from the nearest of the seeds to all vertices no farther than cutoff.
  /// @param allowed  if given, one flag per vertex: only flagged ones are entered
  /// @return         the reached vertices, nearest first; ties by vertex number. Valid until the next call
  const std::vector<int>& run(const std::vector<int>& seeds, double cutoff, const std::vector<char>* allowed = nullptr);

  /// Distance found by the last run, kUnreached where it did not come.
  double distance(int vertex) const { return stamp_[vertex] == 2 * search_ ? distance_[vertex] : kUnreached; }

 private:
  const IndexLists& neighbours_;
  const Points& points_;
  std::vector<double> distance_;
  std::vector<unsigned> stamp_;  // 2 * search_: settled in this run; 2 * search_ - 1: on the heap
  unsigned search_ = 0;
  std::vector<std::pair<double, int>> heap_;
  std::vector<int> reached_;
};

}  // namespace lapedit
