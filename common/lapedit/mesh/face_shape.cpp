// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/face_shape.h"

#include <cmath>

namespace lapedit {

bool measure(const std::array<Vector3, 3>& corners, FaceShape& shape) {
  std::array<Vector3, 3> edges;  // edge k leads from corner k to the next
  for (int k = 0; k < 3; ++k) {
    edges[k] = corners[(k + 1) % 3] - corners[k];
  }
  const Vector3 normal = edges[0].cross(edges[1]);
  const double length = normal.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) {
    return false;
  }
  shape.normal = normal / length;
  for (int k = 0; k < 3; ++k) {
    const Vector3& in = edges[(k + 2) % 3];
    shape.angles[k] = std::atan2(edges[k].cross(-in).norm(), edges[k].dot(-in));
  }
  return true;
}

}  // namespace lapedit
