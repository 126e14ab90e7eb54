// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A linear low-pass over the vertices of a region: what it makes of positions is the underlying smooth surface.
/// Constants are kept, and components do not mix.
class Smoother {
 public:
  virtual ~Smoother() = default;

  /// out = S in, size() x 3 each. in and out must be different objects; out keeps its storage if it has the right size.
  virtual void apply(const Points& in, Points& out) const = 0;

  /// As well as a preview in single precision needs it.
  virtual void apply_roughly(const Points& in, Points& out) const { apply(in, out); }

  virtual std::size_t bytes() const = 0;
};

}  // namespace lapedit
