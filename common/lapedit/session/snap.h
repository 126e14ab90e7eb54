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

/// What a dragged handle snaps to.
enum class SnapTo {
  Off,
  Surfaces,     ///< of other visible layers: the point under the cursor
  PickedPoints  ///< picked points: the nearest to the cursor, within kSnapPixels
};

constexpr double kSnapPixels = 25;

/// The targets of a drag, in the coordinates of the mesh.
class SnapTargets {
 public:
  /// O(faces log faces)
  SnapTargets(std::vector<TriangleMesh> surfaces, std::vector<Vector3> points);

  /// Returns the target at a pixel, none if there is none. Allocates nothing.
  std::optional<Vector3> at(const Camera& view, const Vector2& pixel) const;

 private:
  struct Surface {
    explicit Surface(TriangleMesh taken) : mesh(std::move(taken)), faces(mesh) {}

    TriangleMesh mesh;
    Visibility faces;
  };

  std::list<Surface> surfaces_;  // which stay where they are, as their trees refer to them
  std::vector<Vector3> points_;
};

/// Returns what a translation snaps to; null: nothing.
using FindTargets = std::function<std::shared_ptr<const SnapTargets>(SnapTo)>;

}  // namespace lapedit
