// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/symmetry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/mesh/vertex_grid.h"

namespace lapedit {
namespace {

Vector3 position_of(const Points& points, int v) {
  return points.row(v).transpose();
}

/// Measures how nearly a mesh is its own mirror image, by a sample of its vertices.
class SymmetrySearch {
 public:
  explicit SymmetrySearch(const TriangleMesh& mesh)
      : mesh_(mesh),
        usable_(usable_vertices(mesh)),
        grid_(mesh.vertices, usable_),
        box_(bounding_box(mesh.vertices, usable_)) {
    constexpr std::size_t kSample = 2000;
    const std::size_t stride = usable_.size() / kSample + 1;
    for (std::size_t k = 0; k < usable_.size(); k += stride) {
      sample_.push_back(usable_[k]);
    }
  }

  std::optional<MirrorPlane> find() const;
  double fraction(const MirrorPlane& plane) const {
    return sample_.empty() || !(diagonal() > 0) ? 0 : error(plane) / diagonal();
  }

 private:
  struct Candidate {
    MirrorPlane plane;
    double error;  // mean distance
  };
  std::vector<MirrorPlane> planes() const;
  double diagonal() const { return box_.diagonal().norm(); }
  double error(const MirrorPlane& plane) const;
  MirrorPlane refined(const MirrorPlane& plane) const;

  const TriangleMesh& mesh_;
  std::vector<int> usable_, sample_;
  VertexGrid grid_;
  Eigen::AlignedBox3d box_;
};

constexpr double kGivenUp = 0.05;  // of the diagonal: larger distances count as this

double SymmetrySearch::error(const MirrorPlane& plane) const {
  const Affine mirror = reflection(plane);
  const double limit = kGivenUp * diagonal();
  double sum = 0, off = 0;
  for (const int v : sample_) {
    const Vector3 position = position_of(mesh_.vertices, v), image = mirror * position;
    const int near = grid_.nearest(image, limit);
    sum += near >= 0 ? (position_of(mesh_.vertices, near) - image).norm() : limit;
    off += (image - position).norm() / 2;
  }
  // A flat mesh is not mirrored across its own plane, since it has no vertices on the other side.
  constexpr double kThin = 0.02;
  const auto count = static_cast<double>(sample_.size());
  return off / count > kThin * diagonal() ? sum / count : limit;
}

/// Coordinate axes come first, since the first of equals is taken.
std::vector<MirrorPlane> SymmetrySearch::planes() const {
  Vector3 sum = Vector3::Zero();
  double area = 0;
  Matrix3 spread = Matrix3::Zero();
  const Vector3 middle = box_.center();
  for (const auto& face : mesh_.faces.rowwise()) {
    const Vector3 a = position_of(mesh_.vertices, face[0]) - middle, b = position_of(mesh_.vertices, face[1]) - middle,
                  c = position_of(mesh_.vertices, face[2]) - middle, centre = (a + b + c) / 3;
    const double own = (b - a).cross(c - a).norm() / 2;
    if (std::isfinite(own)) {
      area += own;
      sum += own * centre;
      spread += own * centre * centre.transpose();
    }
  }
  const Vector3 centroid = area > 0 ? Vector3(sum / area) : Vector3::Zero();
  spread = area > 0 ? Matrix3(spread / area - centroid * centroid.transpose()) : Matrix3::Identity();
  const Matrix3 axes = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvectors();
  std::vector<MirrorPlane> result;
  for (const Matrix3& directions : {Matrix3(Matrix3::Identity()), axes}) {
    for (const Vector3& point : {middle, Vector3(middle + centroid)}) {
      for (int k = 0; k < 3; ++k) {
        result.push_back({point, directions.col(k)});
      }
    }
  }
  return result;
}

/// Returns the plane between the sampled vertices and the vertices nearest to their images; its normal is the direction
/// between them.
MirrorPlane SymmetrySearch::refined(const MirrorPlane& plane) const {
  const Affine mirror = reflection(plane);
  const double limit = kGivenUp * diagonal();
  Matrix3 apart = Matrix3::Zero();
  Vector3 between = Vector3::Zero();
  int count = 0;
  for (const int v : sample_) {
    const Vector3 position = position_of(mesh_.vertices, v);
    const int near = grid_.nearest(mirror * position, limit);
    if (near >= 0) {
      const Vector3 other = position_of(mesh_.vertices, near);
      apart += (other - position) * (other - position).transpose();
      between += (other + position) / 2;
      ++count;
    }
  }
  if (count == 0) {
    return plane;
  }
  const Vector3 normal = Eigen::SelfAdjointEigenSolver<Matrix3>(apart).eigenvectors().col(2);
  return {between / count, normal.dot(plane.normal) < 0 ? Vector3(-normal) : normal};
}

std::optional<MirrorPlane> SymmetrySearch::find() const {
  constexpr double kEqual = 1e-6;  // of the diagonal
  constexpr std::size_t kRefined = 4;
  constexpr int kSteps = 20;
  if (sample_.empty() || !(diagonal() > 0)) {
    return {};
  }
  std::vector<Candidate> candidates;
  for (const MirrorPlane& plane : planes()) {
    candidates.push_back({plane, error(plane)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
  Candidate best = candidates[0];
  for (std::size_t k = 0; k < kRefined; ++k) {
    Candidate now = candidates[k];
    for (int step = 0; step < kSteps && now.error > kEqual * diagonal(); ++step) {
      const MirrorPlane plane = refined(now.plane);
      const Candidate next{plane, error(plane)};
      if (!(next.error < now.error)) {
        break;
      }
      now = next;
    }
    if (now.error < best.error - kEqual * diagonal()) {
      best = now;
    }
  }
  return best.error <= kSymmetric * diagonal() ? std::optional<MirrorPlane>(best.plane) : std::nullopt;
}

}  // namespace

Affine reflection(const MirrorPlane& plane) {
  if (!plane.point.allFinite() || !plane.normal.allFinite()) {
    throw EditError(ErrorCause::NotFinite, "The mirror plane is not finite: give a finite point and normal.");
  }
  const double length = plane.normal.stableNorm();
  if (!(length > 0)) {
    throw EditError(ErrorCause::BadParameter,
                    "The mirror plane's normal is (0, 0, 0): give a direction, for example (1, 0, 0).");
  }
  const Vector3 n = plane.normal / length;
  Affine mirror;
  mirror.linear() = Matrix3::Identity() - 2 * n * n.transpose();
  mirror.translation() = 2 * n.dot(plane.point) * n;
  return mirror;
}

double asymmetry(const TriangleMesh& mesh, const MirrorPlane& plane) {
  return SymmetrySearch(mesh).fraction(plane);
}

std::optional<MirrorPlane> find_symmetry(const TriangleMesh& mesh) {
  return SymmetrySearch(mesh).find();
}

}  // namespace lapedit
