// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <limits>
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
  explicit SnapTargets(std::vector<TriangleMesh> surfaces) {
    for (TriangleMesh& mesh : surfaces) {
      surfaces_.emplace_back(std::move(mesh));
    }
  }

  /// Returns the first point of a surface under a pixel, none if there is none. Allocates nothing.
  std::optional<Vector3> at(const Camera& view, const Vector2& pixel) const {
    std::optional<Vector3> found;
    double least = std::numeric_limits<double>::infinity();
    const Ray ray = view.ray(pixel);
    for (const Surface& surface : surfaces_) {
      const std::optional<SurfaceHit> hit = surface.faces.first_hit(ray);
      if (const double far = hit ? (hit->point - ray.origin).squaredNorm() : least; far < least) {
        least = far;
        found = hit->point;
      }
    }
    return found;
  }

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
