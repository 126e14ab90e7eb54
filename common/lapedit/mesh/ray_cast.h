// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/camera.h"
#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// The first intersection of a ray with the surface.
struct SurfaceHit {
  Vector3 point;
  int face = -1;
  int vertex = -1;  ///< the corner of the face that is nearest to the point
};

/// Returns the intersection with a face at a distance along the ray, in units of its direction.
SurfaceHit hit_of(const TriangleMesh& mesh, const Ray& ray, int face, double distance);

/// Returns the distance to a face along the ray, in units of its direction; infinity if the ray misses the face, or if
/// a coordinate is NaN. A ray through a vertex or an edge always hits one of the faces there. Source: T. Moeller, B.
/// Trumbore 1997.
double distance_along(const TriangleMesh& mesh, const Ray& ray, int face);

/// Barycentric coordinates down to minus this count as inside a face.
constexpr double kRaySeam = 1e-9;

/// Returns the normal of a face, twice its area long.
Vector3 area_normal(const TriangleMesh& mesh, int face);

}  // namespace lapedit
