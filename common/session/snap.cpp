// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/snap.h"

#include <limits>
#include <utility>

namespace lapedit {

SnapTargets::SnapTargets(std::vector<TriangleMesh> surfaces) {
  for (TriangleMesh& mesh : surfaces) {
    surfaces_.emplace_back(std::move(mesh));
  }
}

std::optional<Vector3> SnapTargets::at(const Camera& view, const Vector2& pixel) const {
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

}  // namespace lapedit
