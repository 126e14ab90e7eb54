// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace lapedit {

GeodesicSearch::GeodesicSearch(const IndexLists& neighbours, const Points& points)
    : neighbours_(neighbours), points_(points), distance_(points.rows(), 0), stamp_(points.rows(), 0) {}

const std::vector<int>& GeodesicSearch::run(const std::vector<int>& seeds, double cutoff,
                                            const std::vector<char>* allowed) {
  ++search_;
  const unsigned pending = 2 * search_ - 1;
  const unsigned settled = 2 * search_;
  const auto farther = std::greater<std::pair<double, int>>();
  reached_.clear();
  heap_.clear();
  auto offer = [&](int vertex, double distance) {
    if (stamp_[vertex] == settled || (stamp_[vertex] == pending && distance_[vertex] <= distance)) {
      return;
    }
    stamp_[vertex] = pending;
    distance_[vertex] = distance;
    heap_.emplace_back(distance, vertex);
    std::push_heap(heap_.begin(), heap_.end(), farther);
  };
  for (const int seed : seeds) {
    offer(seed, 0);
  }
  while (!heap_.empty()) {
    const auto [distance, vertex] = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), farther);
    heap_.pop_back();
    if (stamp_[vertex] == settled) {
      continue;  // an older, longer way to a vertex already settled
    }
    stamp_[vertex] = settled;
    reached_.push_back(vertex);
    for (const int next : neighbours_[vertex]) {
      if (stamp_[next] == settled || (allowed && !(*allowed)[next])) {
        continue;
      }
      const double through = distance + (points_.row(next) - points_.row(vertex)).norm();
      if (through <= cutoff && std::isfinite(through)) {
        offer(next, through);
      }
    }
  }
  return reached_;
}

}  // namespace lapedit
