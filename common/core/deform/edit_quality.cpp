// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_quality.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/deform/matrix_averages.h"

namespace lapedit {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

double degrees_of(const Matrix3& rotation) {
  return Eigen::AngleAxisd(rotation).angle() * kDegrees;
}

/// Searches for folds only if triangles flipped, since triangles that agree with slowly varying rotations are not
/// folded.
void find_folds(const Region& region, const Points& before, const Points& after, ThreadPool& pool, EditReport& report) {
  if (report.flipped == 0) {
    return;
  }
  AdviceCauses& causes = report.causes;
  const std::vector<Matrix3> surface = surface_rotations(region, before, after, pool);
  std::vector<int> at(region.size(), 0);
  Checkpoints checkpoints;
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    checkpoints();
    if (is_flipped(region, f, before, after, surface)) {
      ++report.folded;
      causes.folds.push_back({region.mesh_vertex[region.faces(f, 0)], region.mesh_vertex[region.faces(f, 1)],
                              region.mesh_vertex[region.faces(f, 2)]});
      for (const int v : region.faces.row(f)) {
        ++at[v];
      }
    }
  }
  if (report.folded > 0) {
    causes.near = region.mesh_vertex[std::max_element(at.begin(), at.end()) - at.begin()];
  }
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      causes.rotation = std::max(causes.rotation, degrees_of(surface[i]));
    }
  }
}

/// Returns the fraction of the region's area that became more than `factor` times as long in some direction.
double stretched_area(const Region& region, const Points& before, const Points& after, double factor) {
  double all = 0, stretched = 0;
  for (const FaceStretch& face : face_stretches(region, before, after)) {
    all += face.area;
    stretched += face.factor > factor ? face.area : 0;
  }
  return all > 0 ? stretched / all : 0;
}

/// The spread of the handles and anchors of a component, and of their targets.
struct Spread {
  Matrix3 before = Matrix3::Zero(), after = Matrix3::Zero();
};

/// Accumulates weighted covariances of positions before and after the edit.
class SpreadSums {
 public:
  void add(double weight, const Vector3& before, const Vector3& after) {
    count_ += weight;
    const double part = count_ > 0 ? weight / count_ : 0;
    step(weight, part, before, middle_before_, spread_.before);
    step(weight, part, after, middle_after_, spread_.after);
  }
  const Spread& spread() const { return spread_; }

 private:
  static void step(double weight, double part, const Vector3& position, Vector3& middle, Matrix3& spread) {
    const Vector3 off = position - middle;
    middle += part * off;
    spread += weight * (1 - part) * off * off.transpose();
  }

  double count_ = 0;
  Vector3 middle_before_ = Vector3::Zero(), middle_after_ = Vector3::Zero();
  Spread spread_;
};

/// Returns the factor by which a spread reduces a volume, at most 1: that of three directions, or of fewer if
/// constraints are in a plane.
double reduction(const Spread& spread) {
  constexpr double kFlat = 1e-6;
  const double size = spread.before.trace();
  if (!(size > 0)) {
    return 1;
  }
  const double before = spread.before.determinant();
  const double ratio = before > kFlat * size * size * size ? std::max(spread.after.determinant(), 0.0) / before
                                                           : spread.after.trace() / size;
  return std::min(1.0, std::sqrt(ratio));
}

/// Returns, per component, the smallest factor of its volume that the constraints imply: the factor of a group's map,
/// or that by which handles and anchors approach each other. Exchanging targets does not change their spread.
std::vector<double> wanted_volumes(const LaplacianSystem& system, const EditConstraints& constraints) {
  const Region& region = system.region;
  const GroupPaths& paths = constraints.paths();
  // Each group counts as much as all anchors together, whatever its number of vertices. There is one entry per
  // component and group in it, and one per component for its anchors, whose group is -1.
  std::map<std::pair<int, int>, double> counts;
  const auto slot = [&](int i) { return std::pair(region.component[i], region.group[i]); };
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] != VertexClass::Free) {
      counts[slot(i)] += 1;
    }
  }
  std::vector<SpreadSums> sums(region.anchored.size());
  std::vector<double> wanted(region.anchored.size(), 1);
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] != VertexClass::Free) {
      const Vector3 from = system.rest.local.row(i).transpose();
      const bool is_handle = region.classes[i] == VertexClass::Handle;
      const int c = region.component[i];
      sums[c].add(1 / counts[slot(i)], from, is_handle ? Vector3(from + constraints.wanted_displacement(i)) : from);
      if (is_handle && counts[slot(i)] > 1) {
        const Matrix3 map = paths.motions()[region.group[i]].linear + Matrix3::Identity();
        wanted[c] = std::min(wanted[c], std::abs(map.determinant()));
      }
    }
  }
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    wanted[c] = std::min(wanted[c], reduction(sums[c].spread()));
  }
  return wanted;
}

void find_lost_volume(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                      LostVolume& lost) {
  constexpr double kHalf = 0.5, kInsideOut = -0.01;
  const Region& region = system.region;
  const std::vector<ComponentVolume> before = component_volumes(region, system.rest.world);
  if (std::none_of(before.begin(), before.end(), [](const ComponentVolume& one) { return one.is_body; })) {
    return;
  }
  const std::vector<ComponentVolume> after = component_volumes(region, positions);
  const std::vector<double> wanted = wanted_volumes(system, constraints);
  double worst = kHalf;
  for (int i = 0; i < region.size(); ++i) {
    const int c = region.component[i];
    const double left = before[c].is_body ? after[c].volume / before[c].volume : 1;
    // A component that should become flat may end with a slightly negative volume.
    const double of_wanted = left < 0 ? (left < kInsideOut ? left : 1) : wanted[c] > 0 ? left / wanted[c] : 1;
    if (of_wanted < worst) {
      worst = of_wanted;
      lost = {region.mesh_vertex[i], before[c].volume, after[c].volume, false};
    }
  }
  const std::size_t groups = constraints.paths().motions().size();
  lost.mirrored = true;
  for (std::size_t g = 0; g < groups; ++g) {
    lost.mirrored &= constraints.paths().mirrors(g);
  }
}

}  // namespace

/// Averages C_i = S_i + |S_i| n' n^T over neighbours, where S_i = sum_j (x_j - x_i)(p_j - p_i)^T over the edges. R_i is
/// the rotation nearest to (1 - h_i) C_i + h_i |C_i| I, where h_i = 3 t^2 - 2 t^3 at the depth t in the anchor band.
std::vector<Matrix3> surface_rotations(const Region& region, const Points& before, const Points& after,
                                       ThreadPool& pool) {
  constexpr int kGrain = 512, kAveragings = 4;
  const int n = region.size();
  Points normals_before, normals_after;
  vertex_normals(before, region.faces, normals_before);
  vertex_normals(after, region.faces, normals_after);
  MatrixAverages covariances(n);
  for_indices(pool, n, kGrain, [&](int i) {
    Matrix3 covariance = Matrix3::Zero();
    for (const int j : region.neighbours[i]) {
      covariance.noalias() += (after.row(j) - after.row(i)).transpose() * (before.row(j) - before.row(i));
    }
    // Two statements, since Eigen would scale one factor first and lose the symmetry for vertices that have not moved.
    const Matrix3 normals = normals_after.row(i).transpose() * normals_before.row(i);
    covariances[i] = covariance + covariance.norm() * normals;
  });
  covariances.average(region.neighbours, kAveragings, pool);
  std::vector<Matrix3> rotations(n);
  // The surface beyond the boundary does not rotate, so rotations fade out across the anchors.
  in_pieces(pool, n, kGrain, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const double hold = region.anchor_depth.empty() ? 0 : smooth_step(region.anchor_depth[i]);
      const Matrix3 covariance = covariances[i];
      rotations[i] = (1 - hold) * covariance + hold * covariance.norm() * Matrix3::Identity();
    }
    nearest_rotations(rotations.data() + first, last - first, rotations.data() + first);
  });
  return rotations;
}

/// Uses |R - S| = 2 sqrt(2) sin(angle / 2).
double largest_rotation(const std::vector<Matrix3>& r, const std::vector<Matrix3>& s, int* at) {
  double largest = 0;
  int found = -1;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double squared = (r[i] - (s.empty() ? Matrix3::Identity() : s[i])).squaredNorm();
    if (squared > largest) {
      largest = squared;
      found = static_cast<int>(i);
    }
  }
  if (at) {
    *at = found;
  }
  return 2 * std::asin(std::min(1.0, std::sqrt(largest / 8))) * kDegrees;
}

void measure_shape(const Region& region, const Points& before, const Points& after,
                   const std::vector<Matrix3>& rotations, ThreadPool& pool, EditReport& report) {
  const EdgeStretch stretch = edge_stretch(region, before, after);
  report.stretch_rms = stretch.rms;
  report.stretch_max = stretch.largest;
  report.causes.stretched = stretch.at < 0 ? -1 : region.mesh_vertex[stretch.at];
  report.flipped = flipped_triangles(region, before, after, rotations);
  find_folds(region, before, after, pool, report);
  const ComponentVolume enclosed = enclosed_volume(region, before);
  report.volume = enclosed.volume;
  report.volume_change = enclosed_volume(region, after).volume - report.volume;
  report.is_body = enclosed.is_body;
}

void measure_edit(const LaplacianSystem& system, const EditConstraints& constraints, const Points& positions,
                  const std::vector<Matrix3>& rotations, EditReport& report) {
  const Region& region = system.region;
  const std::vector<int> lone = lone_vertices(region);
  const std::vector<double> largest = largest_weights(region);
  Checkpoints checkpoints;
  for (int i = 0; i < region.size(); ++i) {
    checkpoints();
    const Vector3 moved = (positions.row(i) - system.rest.world.row(i)).transpose();
    if (region.classes[i] == VertexClass::Handle) {
      const Vector3 wanted = constraints.wanted_displacement(i);
      if (wanted.norm() > report.handle_displacement) {
        report.handle_displacement = wanted.norm();
        report.causes.lone_handle = lone[region.group[i]] >= 0;
      }
      if (region.weight(i) == largest[region.group[i]]) {
        report.handle_residual = std::max(report.handle_residual, (moved - wanted).norm());
      }
      if (region.weight(i) == 1 && (moved - wanted).norm() > report.causes.distance) {
        report.causes.distance = (moved - wanted).norm();
        report.causes.behind = region.mesh_vertex[i];
      }
    } else if (region.classes[i] == VertexClass::Anchor) {
      report.anchor_residual = std::max(report.anchor_residual, moved.norm());
    }
    report.rotation_max = std::max(report.rotation_max, degrees_of(rotations[i]));
  }
  report.causes.reach = region.radius;
  report.causes.rotation = report.rotation_max;
  double scale = 1;  // a handle that is scaled up stretches the surface as much
  for (const auto& motion : constraints.paths().motions()) {
    scale = std::max(scale, (motion.linear + Matrix3::Identity()).norm() / std::sqrt(3.0));
  }
  report.causes.stretched_area = stretched_area(region, system.rest.world, positions, kStretched * scale);
  const Bend bend = bend_at_anchors(region, system.rest.world, positions);
  report.causes.bend = bend.degrees;
  report.causes.bent = bend.at < 0 ? -1 : region.mesh_vertex[bend.at];
  measure_shape(region, system.rest.world, positions, rotations, *system.pool, report);
  find_lost_volume(system, constraints, positions, report.causes.lost);
}

}  // namespace lapedit
