// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/ray_cast.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace lapedit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vector3 corner(const TriangleMesh& mesh, int face, int k) {
  return mesh.vertices.row(mesh.faces(face, k)).transpose();
}

}  // namespace

Vector3 area_normal(const TriangleMesh& mesh, int face) {
  const Vector3 a = corner(mesh, face, 0);
  return (corner(mesh, face, 1) - a).cross(corner(mesh, face, 2) - a);
}

double distance_along(const TriangleMesh& mesh, const Ray& ray, int face) {
  const Vector3 a = corner(mesh, face, 0);
  const Vector3 along = corner(mesh, face, 1) - a;
  const Vector3 across = corner(mesh, face, 2) - a;
  const Vector3 p = ray.direction.cross(across);
  const double determinant = along.dot(p);
  if (!(std::abs(determinant) > 0)) {
    return kInfinity;
  }
  const Vector3 offset = ray.origin - a;
  const double u = offset.dot(p) / determinant;
  if (!(u >= -kRaySeam && u <= 1 + kRaySeam)) {
    return kInfinity;
  }
  const Vector3 q = offset.cross(along);
  const double v = ray.direction.dot(q) / determinant;
  if (!(v >= -kRaySeam && u + v <= 1 + kRaySeam)) {
    return kInfinity;
  }
  const double t = across.dot(q) / determinant;
  return t >= 0 && std::isfinite(t) ? t : kInfinity;
}

SurfaceHit hit_of(const TriangleMesh& mesh, const Ray& ray, int face, double distance) {
  SurfaceHit hit;
  hit.point = ray.origin + distance * ray.direction;
  hit.face = face;
  double closest = kInfinity;
  for (int k = 0; k < 3; ++k) {
    const double away = (corner(mesh, face, k) - hit.point).norm();
    if (away < closest) {
      closest = away;
      hit.vertex = mesh.faces(face, k);
    }
  }
  return hit;
}

}  // namespace lapedit
