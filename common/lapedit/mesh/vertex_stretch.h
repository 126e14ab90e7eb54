// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Stretch of a region's edges against the rest pose, for any number of poses.
class VertexStretch {
 public:
  /// @param rest  the whole mesh
  /// Cost: O(region).
  VertexStretch(const Region& region, const Points& rest);

  /// Returns per vertex of the region the edge that has changed its length most: new / rest - 1 if it is
  /// longer, 1 - rest / new if it is shorter, so that twice as long is 1 and half as long -1. Edges of length zero are
  /// ignored; non-finite values become 0; all values are in [-kMost, kMost].
  /// @param pose  one row per vertex of the region
  /// Cost: two visits of each edge; allocates nothing.
  const std::vector<float>& of(const Points& pose);

  static constexpr float kMost = 1e6F;

 private:
  std::vector<int> offsets_, ends_;  // edges per vertex
  std::vector<float> inverse_rest_;  // 1 / length of each at rest, 0 without one
  std::vector<float> stretch_;
  ThreadPool pool_;
};

}  // namespace lapedit
