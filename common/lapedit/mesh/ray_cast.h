// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lapedit/mesh/camera.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// Where a ray meets the surface first.
struct SurfaceHit {
  Vector3 point;
  int face = -1;
  int vertex = -1;  ///< the corner of the face that is nearest to the point
};

/// The first triangle along a ray, from either side; triangles without area or with a corner that is not finite are
/// looked through. O(faces), a few milliseconds for 300,000: for clicks, not for many rays.
std::optional<SurfaceHit> first_hit(const TriangleMesh& mesh, const Ray& ray);

/// Where a ray meets a face at that distance, in units of its direction.
SurfaceHit hit_of(const TriangleMesh& mesh, const Ray& ray, int face, double distance);

/// Distance to a face along the ray in units of its direction (Moeller and Trumbore 1997), infinity if it misses; NaN
/// misses. Seams between faces are closed: a ray through a vertex or an edge does not slip between them.
double distance_along(const TriangleMesh& mesh, const Ray& ray, int face);

/// Barycentric coordinates may be so much outside a face that the ray still meets it.
constexpr double kRaySeam = 1e-9;

/// Twice the area along the normal of a face.
Vector3 area_normal(const TriangleMesh& mesh, int face);

}  // namespace lapedit
