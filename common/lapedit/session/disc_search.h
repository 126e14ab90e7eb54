// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/geodesic.h"

namespace lapedit {

/// Distances from the middles of discs. Keeps the last search, since several functions need the same disc.
class DiscSearch {
 public:
  /// Mesh and adjacency must outlive the object.
  DiscSearch(const TriangleMesh& mesh, const Adjacency& adjacency) : search_({mesh, adjacency}) {}

  /// Runs a search as GeodesicSearch::run() does, unless the last one was the same.
  const std::vector<int>& run(const std::vector<int>& centers, double radius) {
    if (reached_ == nullptr || centers != centers_ || radius != radius_) {
      reached_ = &search_.run(centers, radius);
      centers_ = centers;
      radius_ = radius;
    }
    return *reached_;
  }
  double distance(int vertex) const { return search_.distance(vertex); }

 private:
  GeodesicSearch search_;
  std::vector<int> centers_;
  double radius_ = 0;
  const std::vector<int>* reached_ = nullptr;
};

}  // namespace lapedit
