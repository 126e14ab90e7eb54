// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>

#include "host_mesh.h"
#include "lapedit/mesh/triangle_mesh.h"

/// What normals are made of, for the files that write into host meshes.
namespace lapedit::host {

inline bool is_finite(const Point3m& point) {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

inline Vector3 to_core(const Point3m& point) {
  return {static_cast<double>(point[0]), static_cast<double>(point[1]), static_cast<double>(point[2])};
}

inline Point3m to_host(const Vector3& point) {
  return {static_cast<Scalarm>(point[0]), static_cast<Scalarm>(point[1]), static_cast<Scalarm>(point[2])};
}

/// Unit normal of a face, and the angles at its corners.
struct FaceShape {
  Vector3 normal;
  std::array<double, 3> angles;
};

/// @return false if the face has no area or a non-finite corner
inline bool measure(const Point3m& a, const Point3m& b, const Point3m& c, FaceShape& shape) {
  if (!is_finite(a) || !is_finite(b) || !is_finite(c)) {
    return false;
  }
  const std::array<Vector3, 3> corners = {to_core(a), to_core(b), to_core(c)};
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

/// Box around all finite vertices.
Box3m finite_box(const CMeshO& host);

}  // namespace lapedit::host
