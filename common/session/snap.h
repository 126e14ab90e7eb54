// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "lapedit/mesh/visibility.h"

namespace lapedit {

/// The surfaces that a dragged handle snaps to, in the coordinates of the mesh.
class SnapTargets {
 public:
  /// O(faces log faces)
  explicit SnapTargets(std::vector<TriangleMesh> surfaces);

  /// Returns the first point of a surface under a pixel, none if there is none. Allocates nothing.
  std::optional<Vector3> at(const Camera& view, const Vector2& pixel) const;

 private:
  struct Surface {
    explicit Surface(TriangleMesh taken) : mesh(std::move(taken)), faces(mesh) {}

    TriangleMesh mesh;
    Visibility faces;
  };

  std::list<Surface> surfaces_;  // a list, since the trees refer to its elements
};

/// Returns what a translation snaps to; null: nothing.
using FindTargets = std::function<std::shared_ptr<const SnapTargets>()>;

}  // namespace lapedit
