// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A linear low-pass S over the vertices of a region: what it makes of positions is the underlying smooth surface.
/// Constants are kept, and components do not mix. One call at a time.
class Smoother {
 public:
  virtual ~Smoother() = default;

  /// out = S in, size() x 3 each. in and out must be different objects; out keeps its storage if it has the right size.
  virtual void apply(const Points& in, Points& out) const = 0;

  /// To some five digits.
  virtual void apply_roughly(const Points& in, Points& out) const { apply(in, out); }

  /// The same map: its tables shared, its scratch another, so that both can be at work at a time, each on a pool of its
  /// own (empty: the caller's thread alone).
  virtual std::unique_ptr<Smoother> share(std::shared_ptr<ThreadPool> pool) const = 0;
};

}  // namespace lapedit
