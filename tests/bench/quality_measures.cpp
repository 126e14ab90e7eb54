// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "lapedit/base/polar_decomposition.h"

namespace quality {
namespace {

using lapedit::Adjacency;
using lapedit::Faces;
using lapedit::Matrix3;
using lapedit::Points;
using lapedit::Vector3;

constexpr double kPi = 3.14159265358979323846;

/// Twice the area, along the normal.
Vector3 cross(const Points& p, const Faces& faces, int f) {
  const Vector3 a = p.row(faces(f, 0));
  return (p.row(faces(f, 1)).transpose() - a).cross(p.row(faces(f, 2)).transpose() - a);
}

/// The rotation that fits best around a vertex. Normals make it well defined where the surroundings are flat.
Matrix3 fitted_rotation(const Adjacency& adjacency, const Faces& faces, const Points& before, const Points& after,
                        int vertex) {
  std::vector<int> ring(adjacency.faces[vertex].begin(), adjacency.faces[vertex].end());
  for (const int w : adjacency.neighbours[vertex]) {
    ring.insert(ring.end(), adjacency.faces[w].begin(), adjacency.faces[w].end());
  }
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());

  const auto centre = [&faces](const Points& p, int f) -> Vector3 {
    return (p.row(faces(f, 0)) + p.row(faces(f, 1)) + p.row(faces(f, 2))).transpose() / 3;
  };
  double area = 0;
  Vector3 middle_before = Vector3::Zero(), middle_after = Vector3::Zero();
  for (const int f : ring) {
    const double weight = cross(before, faces, f).norm();
    area += weight;
    middle_before += weight * centre(before, f);
    middle_after += weight * centre(after, f);
  }
  if (!(area > 0)) {
    return Matrix3::Identity();
  }
  middle_before /= area;
  middle_after /= area;
  Matrix3 positions = Matrix3::Zero(), normals = Matrix3::Zero();
  double size_before = 0, size_after = 0;
  for (const int f : ring) {
    const Vector3 normal = cross(before, faces, f);
    const double weight = normal.norm();
    normals += cross(after, faces, f).stableNormalized() * normal.transpose();
    for (int k = 0; k < 3; ++k) {
      const Vector3 p = before.row(faces(f, k)).transpose() - middle_before;
      const Vector3 q = after.row(faces(f, k)).transpose() - middle_after;
      positions += weight / 3 * q * p.transpose();
      size_before += weight / 3 * p.squaredNorm();
      size_after += weight / 3 * q.squaredNorm();
    }
  }
  const double size = std::sqrt(size_before * size_after);
  return lapedit::polar_rotation(size > 0 ? Matrix3(normals + area / size * positions) : normals);
}

}  // namespace

std::vector<int> region_faces(const Adjacency& adjacency, const lapedit::Region& region) {
  std::vector<int> result;
  for (const int v : region.mesh_vertex) {
    result.insert(result.end(), adjacency.faces[v].begin(), adjacency.faces[v].end());
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

int flipped_triangles(const Adjacency& adjacency, const Faces& faces, const std::vector<int>& looked_at,
                      const Points& before, const Points& after) {
  std::vector<int> vertices;
  for (const int f : looked_at) {
    vertices.insert(vertices.end(), {faces(f, 0), faces(f, 1), faces(f, 2)});
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<Matrix3> rotations;
  rotations.reserve(vertices.size());
  for (const int v : vertices) {
    rotations.push_back(fitted_rotation(adjacency, faces, before, after, v));
  }
  const auto rotation = [&](int v) -> const Matrix3& {
    return rotations[static_cast<std::size_t>(std::lower_bound(vertices.begin(), vertices.end(), v) -
                                              vertices.begin())];
  };
  return static_cast<int>(std::count_if(looked_at.begin(), looked_at.end(), [&](int f) {
    const Matrix3 sum = rotation(faces(f, 0)) + rotation(faces(f, 1)) + rotation(faces(f, 2));
    return (lapedit::polar_rotation(sum) * cross(before, faces, f)).dot(cross(after, faces, f)) < 0;
  }));
}

AreaStretch area_stretch(const Faces& faces, const std::vector<int>& looked_at, const Points& before,
                         const Points& after) {
  constexpr double kLeast = 1e-6, kWorst = 0.01;
  AreaStretch result;
  double sum = 0;
  std::vector<std::pair<double, double>> by_stretch;  // negative absolute logarithm, area
  for (const int f : looked_at) {
    // The metric of the face after, in an orthonormal basis of the face before.
    const auto edge = [&faces, f](const Points& p, int k) -> Vector3 {
      return (p.row(faces(f, k)) - p.row(faces(f, 0))).transpose();
    };
    const Vector3 e = edge(before, 1), g = edge(before, 2);
    const double area = e.cross(g).norm() / 2, length = e.norm();
    if (!(area > 0)) {
      continue;
    }
    const double along = e.dot(g) / length, height = 2 * area / length;
    const Vector3 u = edge(after, 1) / length, v = (edge(after, 2) - along * u) / height;
    const double middle = (u.squaredNorm() + v.squaredNorm()) / 2,
                 radius = std::hypot((u.squaredNorm() - v.squaredNorm()) / 2, u.dot(v));
    const double large = std::log(std::max(middle + radius, kLeast * kLeast)) / 2;
    const double small = std::log(std::max(middle - radius, kLeast * kLeast)) / 2;
    sum += area;
    result.rms += area * (large * large + small * small) / 2;
    result.shear += area * (large - small) * (large - small);
    by_stretch.emplace_back(-std::max(std::abs(large), std::abs(small)), area);
  }
  std::sort(by_stretch.begin(), by_stretch.end());
  double looked = 0;
  for (auto at = by_stretch.begin(); at != by_stretch.end() && looked < kWorst * sum; ++at) {
    result.worst -= at->first * at->second;
    looked += at->second;
  }
  result.rms = std::sqrt(result.rms / sum);
  result.shear = std::sqrt(result.shear / sum);
  result.worst /= looked;
  return result;
}

double detail_tilt(const Adjacency& adjacency, const Faces& faces, const std::vector<int>& vertices,
                   const Points& before, const Points& after) {
  constexpr int kRounds = 20;
  const auto smoothed = [&adjacency](Points points) {
    for (int round = 0; round < kRounds; ++round) {
      const Points old = points;
      for (int v = 0; v < old.rows(); ++v) {
        for (const int w : adjacency.neighbours[v]) {
          points.row(v) += old.row(w);
        }
        points.row(v) /= 1 + adjacency.neighbours[v].size();
      }
    }
    return points;
  };
  const Points smooth_before = smoothed(before), smooth_after = smoothed(after);
  double sum = 0, weights = 0;
  for (const int v : vertices) {
    const Matrix3 rotation = fitted_rotation(adjacency, faces, smooth_before, smooth_after, v);
    const Vector3 old = rotation * (before.row(v) - smooth_before.row(v)).transpose();
    const Vector3 now = (after.row(v) - smooth_after.row(v)).transpose();
    sum += old.squaredNorm() * std::atan2(old.cross(now).norm(), old.dot(now)) * 180 / kPi;
    weights += old.squaredNorm();
  }
  return weights > 0 ? sum / weights : 0;
}

Evenness evenness(const Vector3& along, double from, double to, const Points& before, const Points& after) {
  constexpr int kSlices = 12;
  std::vector<std::vector<int>> slices(kSlices);
  for (int v = 0; v < before.rows(); ++v) {
    const double at = kSlices * (before.row(v).dot(along) - from) / (to - from);
    if (at >= 0 && at < kSlices) {
      slices[static_cast<std::size_t>(at)].push_back(v);
    }
  }
  std::vector<Matrix3> rotations;
  std::vector<Vector3> centres;
  for (const std::vector<int>& slice : slices) {
    const Points p = before(slice, Eigen::all), q = after(slice, Eigen::all);
    const Eigen::RowVector3d p0 = p.colwise().mean(), q0 = q.colwise().mean();
    rotations.push_back(lapedit::polar_rotation((q.rowwise() - q0).transpose() * (p.rowwise() - p0)));
    centres.emplace_back(q0.transpose());
  }
  std::vector<double> turns;
  double mean = 0;
  Evenness result;
  for (std::size_t k = 0; k < centres.size(); ++k) {
    const Vector3 off = centres[k] + centres[kSlices - 1 - k] - centres.front() - centres.back();
    result.asymmetry = std::max(result.asymmetry, off.norm() / (centres.back() - centres.front()).norm());
    if (k > 0) {
      turns.push_back(Eigen::AngleAxisd(rotations[k] * rotations[k - 1].transpose()).angle());
      mean += turns.back() / (kSlices - 1);
    }
  }
  for (const double turn : turns) {
    result.twist = std::max(result.twist, std::abs(turn / mean - 1));
  }
  return result;
}

double volume_change(const Faces& faces, const std::vector<int>& looked_at, const Points& before, const Points& after) {
  std::map<std::pair<int, int>, int> sides;  // directed edge -> faces that have it, less those that have its reverse
  double area = 0;
  for (const int f : looked_at) {
    area += cross(before, faces, f).norm() / 2;
    for (int k = 0; k < 3; ++k) {
      const int a = faces(f, k), b = faces(f, (k + 1) % 3);
      sides[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  Vector3 centre = Vector3::Zero();
  int border = 0;
  for (const auto& [side, count] : sides) {
    if (count != 0) {
      centre += (before.row(side.first) + before.row(side.second)).transpose() / 2;
      ++border;
    }
  }
  centre = border > 0 ? Vector3(centre / border) : Vector3(before.row(faces(looked_at.front(), 0)));
  const auto volume = [&](const Points& p) {
    double sum = 0;
    for (const int f : looked_at) {
      sum += cross(p, faces, f).dot(p.row(faces(f, 0)).transpose() - centre) / 6;
    }
    return sum;
  };
  const double rest = volume(before);
  // A ball has 0.094 of its area to the power of 1.5, a limb as long as 1,600 of its radii a hundredth of that.
  return std::abs(rest) > 0.001 * std::pow(area, 1.5) ? volume(after) / rest - 1
                                                      : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace quality
