// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/surface_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lapedit/base/progress.h"
#include "lapedit/base/similarity.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

/// Returns, per component, the apex of the cones that measure its volume: the mean of the vertices on its border, or
/// any of its vertices if it is closed.
Points centres(const Region& region, const Points& positions) {
  // At an inner vertex each neighbour is the successor in one face and the predecessor in another, so its balance is 0.
  std::vector<std::int64_t> balance(region.size(), 0);
  for (const auto& face : region.faces.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      balance[face[k]] += static_cast<std::int64_t>(face[(k + 1) % 3]) - face[(k + 2) % 3];
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

/// Returns whether a surface is far from flat.
bool is_thick(const ComponentVolume& one) {
  constexpr double kBody = 0.01;  // of area^(3/2); a ball has 0.094, a slender limb 0.04
  return std::abs(one.volume) > kBody * std::pow(one.area, 1.5);
}

}  // namespace

std::vector<FaceStretch> face_stretches(const Region& region, const Points& before, const Points& after) {
  const auto metric = [](const Points& points, const auto& face) {
    const Vector3 u = points.row(face[1]) - points.row(face[0]), v = points.row(face[2]) - points.row(face[0]);
    return Vector3(u.dot(u), u.dot(v), v.dot(v));
  };
  std::vector<FaceStretch> stretches;
  Checkpoints checkpoints;
  for (const auto& face : region.faces.rowwise()) {
    checkpoints();
    constexpr double kNeedle = 1e-6;
    const Vector3 old = metric(before, face), now = metric(after, face);
    const double squared = old[0] * old[2] - old[1] * old[1], size = old[0] + old[2];
    if (squared > kNeedle * size * size) {
      // The larger eigenvalue of old^-1 now, where `old` is positive definite and `now` positive semidefinite.
      const double half = (now[0] * old[2] - 2 * now[1] * old[1] + now[2] * old[0]) / (2 * squared);
      const double product = (now[0] * now[2] - now[1] * now[1]) / squared;
      stretches.push_back({std::sqrt(half + std::sqrt(std::max(0.0, half * half - product))), std::sqrt(squared) / 2});
    }
  }
  return stretches;
}

Bend bend_at_anchors(const Region& region, const Points& before, const Points& after) {
  constexpr double kDegrees = 57.29577951308232;
  const auto is_anchor = [&region](int v) { return region.classes[v] == VertexClass::Anchor; };
  const std::vector<int> partner = paired_sides(region.size(), region.faces);
  const auto corner = [&region](int side) { return region.faces(side / 3, side % 3); };
  std::vector<Vector3> sums(region.size(), Vector3::Zero());  // of length times change, of lengths, of edges
  Checkpoints checkpoints;
  for (int side = 0; side < static_cast<int>(partner.size()); ++side) {
    checkpoints();
    const int other = partner[side], from = corner(side), to = corner(side % 3 == 2 ? side - 2 : side + 1);
    if (other < side || corner(other) == from || !(is_anchor(from) || is_anchor(to))) {
      continue;  // each edge once, between faces of one orientation
    }
    const auto angle = [&](const Points& points) {
      const Vector3 n = area_normal(points, region.faces, side / 3), m = area_normal(points, region.faces, other / 3);
      const Vector3 along = (points.row(to) - points.row(from)).transpose().stableNormalized();
      return std::atan2(along.dot(n.cross(m)), n.dot(m));
    };
    const double length = (before.row(to) - before.row(from)).norm();
    const double change = std::remainder(kDegrees * (angle(after) - angle(before)), 360);
    for (const int v : {from, to}) {
      sums[v] += Vector3(length * change, length, 1);
    }
  }
  Bend most;
  for (int v = 0; v < region.size(); ++v) {
    const double degrees = std::abs(sums[v][0]) * sums[v][2] / (2 * sums[v][1]);
    if (is_anchor(v) && degrees > most.degrees) {
      most = {degrees, v};
    }
  }
  return most;
}

/// Returns whether n' . (R_a + R_b + R_c) n < 0, where n and n' are the normals before and after.
bool is_flipped(const Region& region, Eigen::Index f, const Points& before, const Points& after,
                const std::vector<Matrix3>& rotations) {
  const Matrix3 rotation =
      rotations[region.faces(f, 0)] + rotations[region.faces(f, 1)] + rotations[region.faces(f, 2)];
  return area_normal(after, region.faces, f).dot(rotation * area_normal(before, region.faces, f)) < 0;
}

/// Computes n_i = sum over faces i j k of (p_j - p_i) x (p_k - p_i), normalised.
void vertex_normals(const Points& points, const Faces& faces, Points& normals, Eigen::VectorXd& areas) {
  constexpr double kCancelled = 1e-12;  // the sum of opposite faces is rounding, not a direction
  normals.setZero(points.rows(), 3);
  areas.setZero(points.rows());
  Checkpoints checkpoints;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    checkpoints();
    const Vector3 a = points.row(faces(f, 0)).transpose();
    const Vector3 ab = points.row(faces(f, 1)).transpose() - a;
    const Vector3 ac = points.row(faces(f, 2)).transpose() - a;
    const Vector3 cross = ab.cross(ac);
    const double area = cross.norm();
    for (int k = 0; k < 3; ++k) {
      normals.row(faces(f, k)) += cross.transpose();
      areas[faces(f, k)] += area;
    }
  }
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    const double length = normals.row(i).norm();
    if (length > kCancelled * areas[i]) {
      normals.row(i) /= length;
    } else {
      normals.row(i).setZero();
    }
  }
}

void vertex_normals(const Points& points, const Faces& faces, Points& normals) {
  Eigen::VectorXd areas;
  vertex_normals(points, faces, normals, areas);
}

Vector3 mean_normal(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices) {
  Vector3 sum = Vector3::Zero();
  for (const int v : vertices) {
    for (const int f : adjacency.faces[v]) {
      const Vector3 normal = area_normal(mesh.vertices, mesh.faces, f);
      if (normal.allFinite()) {
        sum += normal;
      }
    }
  }
  return sum;
}

/// The stretch of an edge is |after_i - after_j| / |before_i - before_j| - 1.
EdgeStretch edge_stretch(const Region& region, const Points& before, const Points& after) {
  EdgeStretch result;
  double sum = 0;
  int edges = 0;
  auto link = region.links.begin();  // no part of the surface
  Checkpoints checkpoints;
  for (int i = 0; i < region.size(); ++i) {
    checkpoints();
    for (const int j : region.neighbours[i]) {
      if (link != region.links.end() && *link == std::pair(i, j)) {
        ++link;
        continue;
      }
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
  Checkpoints checkpoints;
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    checkpoints();
    count += is_flipped(region, f, before, after, rotations);
  }
  return count;
}

/// The area normals of a closed surface sum to zero. Those of an open one sum to the negative area normals of caps over
/// its holes.
std::vector<ComponentVolume> component_volumes(const Region& region, const Points& positions) {
  constexpr double kCap = 0.2;  // of the area; half a ball has 0.5
  const Points from = centres(region, positions);
  const std::size_t count = region.anchored.size();
  std::vector<ComponentVolume> result(count);
  std::vector<Vector3> cap(count, Vector3::Zero());
  Checkpoints checkpoints;
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    checkpoints();
    const int c = region.component[region.faces(f, 0)];
    const Vector3 normal = area_normal(positions, region.faces, f);
    const Vector3 corner = positions.row(region.faces(f, 0)).transpose();
    result[c].volume += (corner - from.row(c).transpose()).dot(normal) / 6;
    result[c].area += normal.norm() / 2;
    cap[c] += normal / 2;
  }
  for (std::size_t c = 0; c < count; ++c) {
    result[c].is_body = is_thick(result[c]) && cap[c].norm() < kCap * result[c].area;
  }
  return result;
}

ComponentVolume enclosed_volume(const Region& region, const Points& positions) {
  ComponentVolume sum;
  for (const ComponentVolume& one : component_volumes(region, positions)) {
    sum.volume += one.volume;
    sum.area += one.area;
  }
  sum.is_body = is_thick(sum);
  return sum;
}

bool moved_rigidly(const Region& region, const Points& before, const Points& after, double rounding) {
  constexpr double kRigid = 3e-4;
  std::vector<std::vector<int>> components(region.anchored.size());
  for (int i = 0; i < region.size(); ++i) {
    components[region.component[i]].push_back(i);
  }
  return std::all_of(components.begin(), components.end(), [&](const std::vector<int>& component) {
    const Points from = gather(before, component), to = gather(after, component);
    const Points expected = best_similarity(from, to, 1).all(from);
    checkpoint(static_cast<int>(component.size()));
    const double extent = largest_row(from.rowwise() - from.colwise().mean().eval());
    return largest_row(expected - to) <= kRigid * extent + rounding;
  });
}

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

constexpr int kVerticesPerPiece = 4096;

VertexStretch::VertexStretch(const Region& region, const Points& rest)
    : edges_(build_adjacency(region.size(), region.faces).neighbours),
      stretch_(static_cast<std::size_t>(region.size()), 0.0F),
      pool_(region.size() < 4 * kVerticesPerPiece ? 1 : 0) {
  for (int a = 0; a < region.size(); ++a) {
    for (const int b : edges_[a]) {
      const double length = (rest.row(region.mesh_vertex[a]) - rest.row(region.mesh_vertex[b])).stableNorm();
      inverse_rest_.push_back(static_cast<float>(length > 0 && std::isfinite(1 / length) ? 1 / length : 0));
    }
  }
}

const std::vector<float>& VertexStretch::of(const Points& pose) {
  for_indices(pool_, static_cast<int>(stretch_.size()), kVerticesPerPiece, [&](int i) {
    float most = 0;
    for (int e = edges_.offsets[i]; e < edges_.offsets[i + 1]; ++e) {
      const auto length = static_cast<float>((pose.row(i) - pose.row(edges_.values[e])).norm());
      const float ratio = length * inverse_rest_[e];
      if (inverse_rest_[e] > 0 && std::isfinite(ratio)) {
        const float change = ratio >= 1 ? std::min(ratio - 1, kMost) : std::max(1 - 1 / ratio, -kMost);
        most = std::abs(change) > std::abs(most) ? change : most;
      }
    }
    stretch_[i] = most;
  });
  return stretch_;
}

}  // namespace lapedit
