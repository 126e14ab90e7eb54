// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/symmetry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "lapedit/base/progress.h"
#include "lapedit/base/refuse.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  Eigen::Index count = 0;
  for (const auto& face : mesh.faces.rowwise()) {
    for (int k = 0; k < 3; ++k) {
      const double length = (mesh.vertices.row(face[k]) - mesh.vertices.row(face[(k + 1) % 3])).norm();
      sum += std::isfinite(length) ? length : 0;
      count += std::isfinite(length);
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// Measures how nearly a mesh is its own mirror image, by a sample of its vertices.
class SymmetrySearch {
 public:
  explicit SymmetrySearch(const TriangleMesh& mesh)
      : mesh_(mesh),
        usable_(usable_vertices(mesh)),
        tree_(mesh.vertices, usable_),
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
  VertexTree tree_;
  Eigen::AlignedBox3d box_;
};

constexpr double kGivenUp = 0.05;  // of the diagonal: larger distances count as this

double SymmetrySearch::error(const MirrorPlane& plane) const {
  const Affine mirror = reflection(plane);
  const double limit = kGivenUp * diagonal();
  double sum = 0, off = 0;
  for (const int v : sample_) {
    const Vector3 position = position_of(mesh_.vertices, v), image = mirror * position;
    const int near = tree_.nearest(image, limit);
    sum += near >= 0 ? (position_of(mesh_.vertices, near) - image).norm() : limit;
    off += (image - position).norm() / 2;
  }
  // A flat mesh is not mirrored across its own plane, since it has no vertices on the other side.
  constexpr double kThin = 0.02;
  const auto count = static_cast<double>(sample_.size());
  return off / count > kThin * diagonal() ? sum / count : limit;
}

/// Coordinate axes come first, since detection takes the first of several equally good planes.
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
  Checkpoints checkpoints;
  for (const int v : sample_) {
    checkpoints();
    const Vector3 position = position_of(mesh_.vertices, v);
    const int near = tree_.nearest(mirror * position, limit);
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
    refuse_edit(ErrorCause::NotFinite, {"mirror"}, "The mirror plane is not finite: give a finite point and normal.");
  }
  const double length = plane.normal.stableNorm();
  if (!(length > 0)) {
    refuse_edit(ErrorCause::BadParameter, {"mirror.normal"},
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

MirrorImages::MirrorImages(const TriangleMesh& mesh, const MirrorPlane& plane)
    : mesh_(mesh),
      usable_(usable_vertices(mesh)),
      mirror_(reflection(plane)),
      tree_(mesh.vertices, usable_),
      edge_(mean_edge(mesh)) {
  constexpr double kEdges = 4, kOfDiagonal = 0.02;
  limit_ = std::max(kEdges * edge_, kOfDiagonal * bounding_box(mesh.vertices, usable_).diagonal().norm());
}

int MirrorImages::of(int v) const {
  const Vector3 position = mirror_ * position_of(mesh_.vertices, v);
  return position.allFinite() ? tree_.nearest(position, limit_) : -1;
}

double MirrorImages::distance(const std::pair<int, int>& pair) const {
  return (mirror_ * position_of(mesh_.vertices, pair.second) - position_of(mesh_.vertices, pair.first)).norm();
}

std::vector<MirrorImages::Pairs> MirrorImages::of(const std::vector<std::vector<int>>& sets,
                                                  std::vector<int>& missing) const {
  std::vector<Pairs> all(sets.size());
  std::vector<Eigen::AlignedBox3d> boxes(sets.size());
  std::vector<int> set_of(mesh_.vertices.rows(), -1);  // of several vertices
  Eigen::AlignedBox3d whole;
  Checkpoints checkpoints;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    for (const int v : sets[s]) {
      checkpoints();
      boxes[s].extend(mirror_ * position_of(mesh_.vertices, v));
      const int image = of(v);
      if (image >= 0) {
        all[s].emplace_back(image, v);
      } else {
        missing.push_back(v);
      }
      set_of[v] = sets[s].size() > 1 ? static_cast<int>(s) : -1;
    }
    const Vector3 margin = Vector3::Constant(edge_);
    boxes[s] = Eigen::AlignedBox3d(boxes[s].min() - margin, boxes[s].max() + margin);
    if (sets[s].size() > 1) {
      whole.extend(boxes[s]);
    }
  }
  for (const int v : usable_) {
    checkpoints();
    const Vector3 position = position_of(mesh_.vertices, v);
    const int image = whole.contains(position) ? of(v) : -1;
    if (image >= 0 && set_of[image] >= 0 && boxes[set_of[image]].contains(position)) {
      all[set_of[image]].emplace_back(v, image);
    }
  }
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
  const auto before = [this](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : std::pair(distance(a), a.second) < std::pair(distance(b), b.second);
  };
  for (Pairs& pairs : all) {
    std::sort(pairs.begin(), pairs.end(), before);
    pairs.erase(std::unique(pairs.begin(), pairs.end(), same), pairs.end());
  }
  return all;
}

std::vector<int> MirrorImages::joined(std::vector<int> set, const char* what) const {
  set = sorted_set(std::move(set));
  for (const int v : set) {
    require_vertex(what, v, mesh_.vertices.rows());
  }
  std::vector<int> missing;
  const std::vector<Pairs> image = of({set}, missing);
  for (const auto& pair : image.front()) {
    set.push_back(pair.first);
  }
  return sorted_set(std::move(set));
}

RegionSpec mirrored(const MirrorImages& images, const RegionSpec& region) {
  const bool is_set = region.kind == RegionSpec::Kind::Vertices;
  RegionSpec result = region;
  result.held = images.joined(region.held, "Held vertex");
  if (!is_set) {
    return result;
  }
  result.vertices = images.joined(region.vertices, "Region vertex");
  const KeptAnchors& kept = region.anchors;
  check_anchors(kept, static_cast<int>(images.mesh().vertices.rows()));
  std::map<int, std::size_t> entry;  // indices of the kept anchors
  for (std::size_t k = 0; k < kept.vertices.size(); ++k) {
    entry.emplace(kept.vertices[k], k);
  }
  std::vector<int> missing;
  const std::vector<MirrorImages::Pairs> image = images.of({sorted_set(kept.vertices)}, missing);
  for (const auto& [v, original] : image.front()) {
    if (entry.count(v) == 0) {  // a vertex that was an anchor keeps its weight and depth
      result.anchors.add(v, kept.weights[entry[original]], kept.depths[entry[original]]);
    }
  }
  return result;
}

PoseSymmetry::PoseSymmetry(const TriangleMesh& mesh, const Region& region, const MirrorPlane& plane)
    : rest_(gather(mesh.vertices, region.mesh_vertex)) {
  constexpr double kSame = 1e-6;
  const Affine mirror = reflection(plane);
  mirror_ = mirror.linear();
  std::vector<int> all(region.size());
  std::iota(all.begin(), all.end(), 0);
  const double limit = kSame * bounding_box(mesh.vertices, usable_vertices(mesh)).diagonal().norm();
  const VertexTree tree(rest_, all);
  twin_.resize(region.size());
  Checkpoints checkpoints;
  for (int i = 0; i < region.size(); ++i) {
    checkpoints();
    twin_[i] = tree.nearest(mirror * position_of(rest_, i), limit);
  }
  const auto alone = [this](int i) { return twin_[i] < 0 || twin_[twin_[i]] != i; };
  if (std::any_of(all.begin(), all.end(), alone)) {
    twin_.clear();
    rest_.resize(0, 3);
  }
}

/// Averages displacements and not positions, so that asymmetries of the rest pose remain.
void PoseSymmetry::apply(Points& positions) const {
  for (int i = 0; i < static_cast<int>(twin_.size()); ++i) {
    if (const int j = twin_[i]; i <= j) {
      const Vector3 a = (positions.row(i) - rest_.row(i)).transpose(),
                    b = (positions.row(j) - rest_.row(j)).transpose();
      if (a == mirror_ * b) {
        continue;  // vertices that do not move keep their bits
      }
      const Vector3 mean = (a + mirror_ * b) / 2;
      positions.row(i) = rest_.row(i) + mean.transpose();
      if (i != j) {
        positions.row(j) = rest_.row(j) + (mirror_ * mean).transpose();
      }
    }
  }
}

}  // namespace lapedit
