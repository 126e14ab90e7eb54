// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// How much longer or shorter the edges of a region are than they were at rest, from pose to pose.
class VertexStretch {
 public:
  /// @param rest  the whole mesh
  /// Cost: O(region).
  VertexStretch(const Region& region, const Points& rest);

  /// Per vertex of the region, of the edges at it, the one that has changed its length most: new / rest - 1 if it is
  /// longer, 1 - rest / new if it is shorter, so that twice as long is 1 and half as long -1. Edges that had no length
  /// do not count; what is not finite is 0; all values are in [-kMost, kMost].
  /// @param pose  one row per vertex of the region
  /// Cost: two looks at each edge; nothing is allocated.
  const std::vector<float>& of(const Points& pose);

  static constexpr float kMost = 1e6F;

 private:
  std::vector<int> offsets_, ends_;  // edges per vertex
  std::vector<float> inverse_rest_;  // 1 / length of each at rest, 0 without one
  std::vector<float> stretch_;
  ThreadPool pool_;
};

}  // namespace lapedit
