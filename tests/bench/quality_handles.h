// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/vertex_finder.h"
#include "lapedit/mesh/vertex_set.h"
#include "quality_edits.h"

/// Handle groups and their maps, for the definitions of edits.
namespace quality {

using lapedit::Affine;
using lapedit::RegionSpec;
using lapedit::TriangleMesh;
using lapedit::Vector3;

constexpr double kPi = 3.14159265358979323846;

inline int vertex_at(const TriangleMesh& mesh, const Vector3& place) {
  return lapedit::nearest_vertex(mesh, place);
}

template <typename Condition>
std::vector<int> vertices_where(const TriangleMesh& mesh, Condition condition) {
  std::vector<int> result;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    if (condition(Vector3(mesh.vertices.row(v)))) {
      result.push_back(v);
    }
  }
  return result;
}

/// All within a distance along the surface.
inline std::vector<int> patch(const TriangleMesh& mesh, int vertex, double radius) {
  const auto adjacency = lapedit::build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  lapedit::GeodesicSearch search(adjacency.neighbours, mesh.vertices);
  return search.run({vertex}, radius);
}

inline RegionSpec within(double radius) {
  RegionSpec spec;
  spec.radius = radius;
  return spec;
}

inline Affine shift(double x, double y, double z) {
  return Affine(Eigen::Translation3d(x, y, z));
}

/// Turned about an axis through a point, then moved.
inline Affine turn(double degrees, const Vector3& axis, const Vector3& centre, const Vector3& way = Vector3::Zero()) {
  const Eigen::AngleAxisd rotation(degrees * kPi / 180, axis.normalized());
  return Affine(Eigen::Translation3d(centre + way) * rotation * Eigen::Translation3d(-centre));
}

/// A limb's end turned as if the limb, from its root on, became an arc of the same length.
/// @param along  from the root to the end
inline Affine arc(double degrees, const Vector3& axis, const Vector3& root, const Vector3& along) {
  const double angle = degrees * kPi / 180;
  const Vector3 side = axis.normalized().cross(along);
  const Vector3 end = along * (std::sin(angle) / angle) + side * ((1 - std::cos(angle)) / angle);
  return turn(degrees, axis, root + along, end - along);
}

/// Where a group is.
inline Vector3 middle(const TriangleMesh& mesh, const std::vector<int>& group) {
  Vector3 sum = Vector3::Zero();
  for (const int v : group) {
    sum += Vector3(mesh.vertices.row(v));
  }
  return sum / static_cast<double>(group.size());
}

}  // namespace quality
