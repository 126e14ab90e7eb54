// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "lapedit/base/thread_pool.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A linear low-pass filter S over the vertices of a region; applied to positions it gives the underlying smooth
/// surface. It keeps constants and does not mix components. Not thread-safe: one call at a time.
class Smoother {
 public:
  virtual ~Smoother() = default;

  /// Computes out = S in, size() x 3 each. `in` and `out` must be different objects; `out` keeps its storage if it has
  /// the right size.
  virtual void apply(const Points& in, Points& out) const = 0;

  /// Computes the same to about five digits.
  virtual void apply_roughly(const Points& in, Points& out) const { apply(in, out); }

  /// Returns the same map with shared tables and its own scratch memory, so that both can be used at the same time,
  /// each with its own pool (null: the caller's thread alone).
  virtual std::unique_ptr<Smoother> share(std::shared_ptr<ThreadPool> pool) const = 0;
};

}  // namespace lapedit
