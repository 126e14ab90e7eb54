// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_quality.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace lapedit {
namespace {

/// Of length twice the area.
Vector3 face_normal(const Points& points, const Faces& faces, Eigen::Index face) {
  const Vector3 a = points.row(faces(face, 0)).transpose();
  const Vector3 b = points.row(faces(face, 1)).transpose();
  const Vector3 c = points.row(faces(face, 2)).transpose();
  return (b - a).cross(c - a);
}

}  // namespace

/// |after_i - after_j| / |before_i - before_j| - 1
EdgeStretch edge_stretch(const Region& region, const Points& before, const Points& after) {
  EdgeStretch result;
  double sum = 0;
  int edges = 0;
  for (int i = 0; i < region.size(); ++i) {
    for (const int j : region.neighbours[i]) {
      const double old_length = (before.row(i) - before.row(j)).norm();
      if (i < j && old_length > 0) {
        const double stretch = (after.row(i) - after.row(j)).norm() / old_length - 1;
        sum += stretch * stretch;
        result.largest = std::max(result.largest, stretch);
        ++edges;
      }
    }
  }
  result.rms = edges > 0 ? std::sqrt(sum / edges) : 0;
  return result;
}

/// n' . (R_a + R_b + R_c) n < 0
int flipped_triangles(const Region& region, const Points& before, const Points& after,
                      const std::vector<Matrix3>& rotations) {
  int count = 0;
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    const Matrix3 turn = rotations[region.faces(f, 0)] + rotations[region.faces(f, 1)] + rotations[region.faces(f, 2)];
    count += face_normal(after, region.faces, f).dot(turn * face_normal(before, region.faces, f)) < 0;
  }
  return count;
}

EditQuality edit_quality(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                         const std::vector<Matrix3>& rotations) {
  EditQuality result;
  const Region& region = system.region;
  for (int i = 0; i < region.size(); ++i) {
    const Vector3 moved = (positions.row(i) - system.rest.world.row(i)).transpose();
    if (region.classes[i] == VertexClass::Handle) {
      const Vector3 way = constraints.wanted_way(i);
      result.handle_displacement = std::max(result.handle_displacement, way.norm());
      result.handle_residual = std::max(result.handle_residual, (moved - way).norm());
    } else if (region.classes[i] == VertexClass::Anchor) {
      const Vector3 way = constraints.carried(i).displacement(system.rest.local.row(i).transpose());
      result.anchor_residual = std::max(result.anchor_residual, (moved - way).norm());
    }
    const double degrees = Eigen::AngleAxisd(rotations[i]).angle() * (180 / 3.14159265358979323846);
    result.rotation_mean += degrees / region.size();
    result.rotation_max = std::max(result.rotation_max, degrees);
  }
  const EdgeStretch stretch = edge_stretch(region, system.rest.world, positions);
  result.stretch_rms = stretch.rms;
  result.stretch_max = stretch.largest;
  result.flipped = flipped_triangles(region, system.rest.world, positions, rotations);
  return result;
}

}  // namespace lapedit
