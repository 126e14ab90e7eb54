// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_quality.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/smooth_normals.h"

namespace lapedit {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

/// Smooths nothing: rotations are fitted to the surface itself.
class Unsmoothed : public Smoother {
 public:
  void apply(const Points& in, Points& out) const override { out = in; }
  std::unique_ptr<Smoother> share(std::shared_ptr<ThreadPool> /*pool*/) const override {
    return std::make_unique<Unsmoothed>();
  }
};

/// Returns the normal, with twice the area as its length.
Vector3 face_normal(const Points& points, const Faces& faces, Eigen::Index face) {
  const Vector3 a = points.row(faces(face, 0)).transpose();
  const Vector3 b = points.row(faces(face, 1)).transpose();
  const Vector3 c = points.row(faces(face, 2)).transpose();
  return (b - a).cross(c - a);
}

/// n' . (R_a + R_b + R_c) n < 0
bool is_flipped(const Region& region, Eigen::Index f, const Points& before, const Points& after,
                const std::vector<Matrix3>& rotations) {
  const Matrix3 turn = rotations[region.faces(f, 0)] + rotations[region.faces(f, 1)] + rotations[region.faces(f, 2)];
  return face_normal(after, region.faces, f).dot(turn * face_normal(before, region.faces, f)) < 0;
}

double degrees_of(const Matrix3& rotation) {
  return Eigen::AngleAxisd(rotation).angle() * kDegrees;
}

/// Returns the apex of the cones of each vertex's component: the mean of the vertices on its border, or any of its
/// vertices if it is closed.
Points centres(const Region& region, const Points& positions) {
  // At an inner vertex each neighbour is the successor in one face and the predecessor in another.
  std::vector<long> balance(region.size(), 0);
  for (const auto& face : region.faces.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      balance[face[k]] += static_cast<long>(face[(k + 1) % 3]) - face[(k + 2) % 3];
    }
  }
  const auto components = static_cast<Eigen::Index>(region.anchored.size());
  Points result = Points::Zero(components, 3);
  Eigen::VectorXi counts = Eigen::VectorXi::Zero(components);
  for (int i = 0; i < region.size(); ++i) {
    const int c = region.component[i];
    if (balance[i] != 0) {
      result.row(c) += (positions.row(i) - positions.row(0) - result.row(c)) / ++counts[c];
    }
  }
  result.rowwise() += positions.row(0);
  for (int i = region.size() - 1; i >= 0; --i) {
    if (counts[region.component[i]] == 0) {
      result.row(region.component[i]) = positions.row(i);
    }
  }
  return result;
}

/// n . (p - S p)
Eigen::VectorXd heights(const Region& region, const Points& places, const Points& smooth) {
  Points normals;
  vertex_normals(smooth, region.faces, normals);
  return (places - smooth).cwiseProduct(normals).rowwise().sum();
}

/// Only if triangles flipped: triangles that agree with slowly varying rotations are not folded.
void find_folds(const LaplacianSystem& system, const Points& positions, EditQuality& result) {
  const Region& region = system.region;
  AdviceCauses& causes = result.causes;
  causes.reach = region.radius;
  causes.turn = result.rotation_max;
  if (result.flipped == 0) {
    return;
  }
  const std::vector<Matrix3> surface = surface_rotations(region, system.rest.world, positions, *system.pool);
  std::vector<int> at(region.size(), 0);
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    if (is_flipped(region, f, system.rest.world, positions, surface)) {
      ++result.folded;
      for (const int v : region.faces.row(f)) {
        ++at[v];
      }
    }
  }
  if (result.folded > 0) {
    causes.near = region.mesh_vertex[std::max_element(at.begin(), at.end()) - at.begin()];
  }
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      causes.turn = std::max(causes.turn, degrees_of(surface[i]));
    }
  }
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
        if (stretch > result.largest) {
          result.largest = stretch;
          result.at = i;
        }
        ++edges;
      }
    }
  }
  result.rms = edges > 0 ? std::sqrt(sum / edges) : 0;
  return result;
}

int flipped_triangles(const Region& region, const Points& before, const Points& after,
                      const std::vector<Matrix3>& rotations) {
  int count = 0;
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    count += is_flipped(region, f, before, after, rotations);
  }
  return count;
}

std::vector<Matrix3> surface_rotations(const Region& region, const Points& before, const Points& after,
                                       ThreadPool& pool) {
  const Unsmoothed as_it_is;
  RotationEstimator estimator(DetailRotation::SmoothSurface, region, as_it_is, pool);
  std::vector<Matrix3> rotations;
  estimator.set_before(before);
  estimator.estimate(after - before, rotations);
  return rotations;
}

double enclosed_volume(const Region& region, const Points& positions) {
  const Points from = centres(region, positions);
  double sum = 0;
  for (const auto& face : region.faces.rowwise()) {
    const auto centre = from.row(region.component[face[0]]);
    const Vector3 a = positions.row(face[0]) - centre, b = positions.row(face[1]) - centre,
                  c = positions.row(face[2]) - centre;
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

std::optional<double> detail_height(const LaplacianSystem& system, const Points& after) {
  if (!system.smoother) {
    return {};
  }
  const Region& region = system.region;
  const auto smoother = system.smoother->share(system.pool);
  Points places = system.rest.world.rowwise() - system.rest.world.row(0), smooth;
  smoother->apply_roughly(places, smooth);
  const Eigen::VectorXd old_heights = heights(region, places, smooth);
  places = after.rowwise() - after.row(0);
  smoother->apply_roughly(places, smooth);
  const Eigen::VectorXd new_heights = heights(region, places, smooth);
  double found = 0, all = 0, reach = 0;
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Free) {
      found += new_heights[i] * old_heights[i];
      all += old_heights[i] * old_heights[i];
      reach += region.max_distance * region.max_distance;
    }
  }
  constexpr double kFlat = 1e-6;  // of the region's size: the error of a plane in single precision
  return all > kFlat * kFlat * reach ? std::optional<double>(found / all) : std::nullopt;
}

/// |R - S| = 2 sqrt(2) sin(angle / 2)
double largest_turn(const std::vector<Matrix3>& r, const std::vector<Matrix3>& s) {
  double largest = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    largest = std::max(largest, (r[i] - (s.empty() ? Matrix3::Identity() : s[i])).squaredNorm());
  }
  return 2 * std::asin(std::min(1.0, std::sqrt(largest / 8))) * kDegrees;
}

EditQuality edit_quality(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                         const std::vector<Matrix3>& rotations) {
  EditQuality result;
  const Region& region = system.region;
  const std::vector<int> lone = lone_vertices(region);
  const std::vector<double> largest = largest_shares(region);
  for (int i = 0; i < region.size(); ++i) {
    const Vector3 moved = (positions.row(i) - system.rest.world.row(i)).transpose();
    if (region.classes[i] == VertexClass::Handle) {
      const Vector3 way = constraints.wanted_way(i);
      if (way.norm() > result.handle_displacement) {
        result.handle_displacement = way.norm();
        result.causes.lone_handle = lone[region.group[i]] >= 0;
      }
      if (region.share(i) == largest[region.group[i]]) {
        result.handle_residual = std::max(result.handle_residual, (moved - way).norm());
      }
      if (region.share(i) == 1 && (moved - way).norm() > result.causes.distance) {
        result.causes.distance = (moved - way).norm();
        result.causes.behind = region.mesh_vertex[i];
      }
    } else if (region.classes[i] == VertexClass::Anchor) {
      const Vector3 way = constraints.carried(i).displacement(system.rest.local.row(i).transpose());
      result.anchor_residual = std::max(result.anchor_residual, (moved - way).norm());
    }
    const double degrees = degrees_of(rotations[i]);
    result.rotation_mean += degrees / region.size();
    result.rotation_max = std::max(result.rotation_max, degrees);
  }
  const EdgeStretch stretch = edge_stretch(region, system.rest.world, positions);
  result.stretch_rms = stretch.rms;
  result.stretch_max = stretch.largest;
  result.causes.stretched = stretch.at < 0 ? -1 : region.mesh_vertex[stretch.at];
  result.flipped = flipped_triangles(region, system.rest.world, positions, rotations);
  find_folds(system, positions, result);
  result.volume = enclosed_volume(region, system.rest.world);
  result.volume_change = enclosed_volume(region, positions) - result.volume;
  double twice_area = 0;
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    twice_area += face_normal(system.rest.world, region.faces, f).norm();
  }
  constexpr double kBody = 0.01;  // of area^(3/2); a ball has 0.094, a slender limb 0.04
  result.is_body = std::abs(result.volume) > kBody * std::pow(twice_area / 2, 1.5);
  return result;
}

}  // namespace lapedit
