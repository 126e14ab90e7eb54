// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/surface_index.h"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/surface_measures.h"

namespace lapedit {
namespace {

Points centres_of(const Points& points, const Faces& faces) {
  Points centres(faces.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    centres.row(f) = (points.row(faces(f, 0)) + points.row(faces(f, 1)) + points.row(faces(f, 2))) / 3;
  }
  return centres;
}

/// Returns the corners of a face in their order along an axis, so that it does not depend on numbers or orientation.
std::array<int, 3> corners_along(const Points& points, const Faces& faces, int face, const Vector3& axis) {
  std::array<int, 3> corners = {0, 1, 2};
  std::sort(corners.begin(), corners.end(),
            [&](int a, int b) { return points.row(faces(face, a)).dot(axis) < points.row(faces(face, b)).dot(axis); });
  return corners;
}

/// Spreads the lower 21 bits of a number to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

}  // namespace

/// Source: C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
Vector3 nearest_weights(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) {
    return Vector3::UnitX();
  }
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) {
    return Vector3::UnitY();
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) {
    return Vector3::UnitZ();
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

std::vector<int> order_by_position(const Points& points) {
  constexpr double kCells = 0x1p21 - 1;
  const Eigen::RowVector3d low = points.colwise().minCoeff();
  const double step = std::max((points.colwise().maxCoeff() - low).maxCoeff(), 1e-300) / kCells;
  std::vector<std::pair<std::uint64_t, int>> codes(static_cast<std::size_t>(points.rows()));
  for (int k = 0; k < points.rows(); ++k) {
    const auto along = [&](int axis) {
      return spread(static_cast<std::uint64_t>((points(k, axis) - low[axis]) / step));
    };
    codes[static_cast<std::size_t>(k)] = {along(0) | along(1) << 1 | along(2) << 2, k};
  }
  std::sort(codes.begin(), codes.end());
  std::vector<int> order(codes.size());
  std::transform(codes.begin(), codes.end(), order.begin(), [](const auto& code) { return code.second; });
  return order;
}

Eigen::VectorXd face_areas(const Points& points, const Faces& faces) {
  Eigen::VectorXd areas(faces.rows());
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    areas[f] = faces(f, 0) == faces(f, 1) ? 1 : 0.5 * area_normal(points, faces, f).norm();
  }
  return areas;
}

/// By loops, since versions of Eigen sum dot products in different orders.
SurfaceSize size_of(const Points& points, const Faces& faces) {
  const Eigen::VectorXd areas = face_areas(points, faces);
  const Points centres = centres_of(points, faces);
  Vector3 centroid = Vector3::Zero();
  double sum = 0, squares = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    centroid += areas[f] * centres.row(f).transpose();
    sum += areas[f];
  }
  centroid /= sum;
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    squares += areas[f] * (centres.row(f).transpose() - centroid).squaredNorm();
  }
  return {centroid, std::sqrt(2 * squares / sum)};
}

SurfaceIndex::SurfaceIndex(Points points, Faces faces, Points normals)
    : points_(std::move(points)), faces_(std::move(faces)), normals_(std::move(normals)) {
  border_.assign(static_cast<std::size_t>(points_.rows()), 0);
  if (!is_cloud()) {
    vertex_normals(points_, faces_, normals_);
    const Faces edges = border_edges(faces_);
    for (const int v : edges.reshaped()) {
      border_[v] = 1;
    }
  }
  std::vector<int> order(static_cast<std::size_t>(faces_.rows()));
  std::iota(order.begin(), order.end(), 0);
  nodes_.reserve(order.size() / 2 + 1);
  build(order.data(), order.data() + order.size(), centres_of(points_, faces_));
  ThreadPool alone(1);
  enclose(alone);
}

int SurfaceIndex::build(int* first, int* last, const Points& centres) {
  const auto node = nodes_.size();
  nodes_.emplace_back().count = 0;
  const auto halve = [&centres](int* from, int* to) {
    Checkpoints checkpoints;
    Eigen::AlignedBox3d box;
    for (const int* f = from; f < to; ++f) {
      box.extend(centres.row(*f).transpose());
    }
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    int* const middle = from + (to - from) / 2;
    std::nth_element(from, middle, to, [&](int a, int b) {
      checkpoints();
      return std::pair(centres(a, axis), a) < std::pair(centres(b, axis), b);
    });
    return middle;
  };
  checkpoint(static_cast<int>(last - first));
  int* const middle = halve(first, last);
  int* const ends[] = {first, halve(first, middle), middle, halve(middle, last), last};
  for (int k = 0; k < 4; ++k) {
    if (ends[k] < ends[k + 1]) {
      const int child = ends[k + 1] - ends[k] == 1 ? ~*ends[k] : build(ends[k], ends[k + 1], centres);
      nodes_[node].child[nodes_[node].count++] = child;
    }
  }
  return static_cast<int>(node);
}

void SurfaceIndex::enclose(ThreadPool& pool) {
  constexpr int kGrain = 512;
  const int count = static_cast<int>(nodes_.size());
  for_indices(pool, count, kGrain, [&](int at) {
    Node& node = nodes_[static_cast<std::size_t>(at)];
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis].setConstant(std::numeric_limits<float>::max());
      node.high[axis] = -node.low[axis];
      for (int k = 0; k < node.count; ++k) {
        for (int c = 0; c < 3 && node.child[k] < 0; ++c) {
          const auto value = static_cast<float>(points_(faces_(~node.child[k], c), axis));
          node.low[axis][k] = std::min(node.low[axis][k], value);
          node.high[axis][k] = std::max(node.high[axis][k], value);
        }
      }
    }
  });
  for (int at = count - 1; at >= 0; --at) {
    Node& node = nodes_[static_cast<std::size_t>(at)];
    for (int k = 0; k < node.count; ++k) {
      for (int axis = 0; axis < 3 && node.child[k] >= 0; ++axis) {
        node.low[axis][k] = nodes_[static_cast<std::size_t>(node.child[k])].low[axis].minCoeff();
        node.high[axis][k] = nodes_[static_cast<std::size_t>(node.child[k])].high[axis].maxCoeff();
      }
    }
  }
  reach_ = 0;  // of the faces, since other points may be NaN
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < nodes_[0].count; ++k) {
      const float farthest = std::max(-nodes_[0].low[axis][k], nodes_[0].high[axis][k]);
      reach_ = std::max(reach_, static_cast<double>(farthest));
    }
  }
}

void SurfaceIndex::move(const Points& points, ThreadPool& pool) {
  points_ = points;
  vertex_normals(points_, faces_, normals_);
  enclose(pool);
}

/// Replaces `best` by the nearest of the accepted points that are nearer. @param hint  as of nearest()
template <class Accept>
void SurfaceIndex::search(const Vector3& point, int hint, const Accept& accept, NearestPoint& best) const {
  // Boxes and distances to them are rounded, so the search also visits boxes that are farther by the rounding error.
  constexpr double kRounding = 0x1p-20;
  const double rounding = kRounding * (reach_ + point.cwiseAbs().maxCoeff());
  const float at[] = {static_cast<float>(point[0]), static_cast<float>(point[1]), static_cast<float>(point[2])};
  float limit = 0;
  const auto update_limit = [&] {
    const double most = std::sqrt(best.squared) + rounding;
    limit = static_cast<float>(most * most * (1 + kRounding));
  };
  update_limit();
  const auto visit = [&](int face) {
    const Vector3 a = points_.row(faces_(face, 0)).transpose(), b = points_.row(faces_(face, 1)).transpose(),
                  c = points_.row(faces_(face, 2)).transpose(), weights = nearest_weights(point, a, b, c);
    const double squared = (weights[0] * a + weights[1] * b + weights[2] * c - point).squaredNorm();
    const bool nearer = squared < best.squared || (squared == best.squared && face < best.face);
    if (nearer && accept(NearestPoint{face, squared, weights})) {
      best = {face, squared, weights};
      update_limit();
    }
  };
  visit(std::max(hint, 0));
  struct Open {
    float squared;
    int child;
  };
  Open stack[64];  // at most three entries per level, at most 16 levels
  int open = 0;
  stack[open++] = {0, 0};
  while (open > 0) {
    const Open next = stack[--open];
    if (next.squared > limit) {
      continue;
    }
    if (next.child < 0) {
      visit(~next.child);
      continue;
    }
    const Node& node = nodes_[static_cast<std::size_t>(next.child)];
    Eigen::Array4f squared = Eigen::Array4f::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      squared += (node.low[axis] - at[axis]).max(at[axis] - node.high[axis]).max(0.0F).square();
    }
    const int base = open;
    for (int k = 0; k < node.count; ++k) {  // the nearest on top
      if (squared[k] <= limit) {
        int slot = open++;
        for (; slot > base && stack[slot - 1].squared < squared[k]; --slot) {
          stack[slot] = stack[slot - 1];
        }
        stack[slot] = {squared[k], node.child[k]};
      }
    }
  }
}

NearestPoint SurfaceIndex::nearest(const Vector3& point, int hint) const {
  NearestPoint best;
  best.squared = std::numeric_limits<double>::infinity();
  search(
      point, hint, [](const NearestPoint&) { return true; }, best);
  return best;
}

NearestPoint SurfaceIndex::nearest_facing(const Vector3& point, const Vector3& normal, double cosine,
                                          double limit) const {
  NearestPoint best;
  best.squared = limit * limit;
  search(
      point, -1, [&](const NearestPoint& at) { return faces_along(at, normal, cosine); }, best);
  return best;
}

bool SurfaceIndex::faces_along(const NearestPoint& at, const Vector3& direction, double cosine) const {
  const Vector3 own = normal(at);
  return own.norm() > 0 && own.dot(direction) >= cosine * own.norm();
}

Vector3 SurfaceIndex::interpolated(const Points& rows, const NearestPoint& at) const {
  Vector3 sum = Vector3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (at.weights[k] != 0) {
      sum += at.weights[k] * rows.row(faces_(at.face, k)).transpose();
    }
  }
  return sum;
}

bool SurfaceIndex::ends_at(const NearestPoint& at) const {
  bool inside = true, all = true;
  for (int k = 0; k < 3; ++k) {
    inside = inside && at.weights[k] != 0;
    all = all && (at.weights[k] == 0 || border_[static_cast<std::size_t>(faces_(at.face, k))] != 0);
  }
  return !inside && all;
}

Matrix3 principal_axes(const Points& points, const Faces& faces) {
  const SurfaceSize whole = size_of(points, faces);
  const Points centred = (centres_of(points, faces).rowwise() - whole.centroid.transpose()) / whole.size;
  const Eigen::VectorXd areas = face_areas(points, faces);
  const double sum = areas.sum();
  // Moments are rounded, so that those of symmetric surfaces do not depend on the order of summation.
  constexpr double kUnit = 0x1p-36;
  Matrix3 moments = Matrix3::Zero();
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    moments += areas[f] / sum * (centred.row(f).transpose() * centred.row(f));
  }
  moments = (moments / kUnit).array().round();
  Matrix3 axes = Eigen::JacobiSVD<Matrix3>(moments, Eigen::ComputeFullU).matrixU();
  for (int axis = 0; axis < 3; ++axis) {
    double skewness = 0;
    for (Eigen::Index f = 0; f < areas.size(); ++f) {
      const double along = centred.row(f).dot(axes.col(axis));
      skewness += areas[f] / sum * along * along * along;
    }
    axes.col(axis) *= skewness < -kUnit ? -1 : 1;
  }
  return axes;
}

SurfaceSamples SurfaceIndex::samples(int count, const Matrix3& axes) const {
  const std::vector<int> order = order_by_position(centres_of(points_, faces_) * axes);
  const Vector3 oblique = axes * Vector3(0.55, 0.35, 0.76);  // along no edge of a regular mesh
  const Eigen::VectorXd areas = face_areas(points_, faces_);
  const bool cloud = is_cloud();
  count = cloud ? std::min(count, static_cast<int>(faces_.rows())) : count;
  const double step = areas.sum() / count;
  SurfaceSamples samples = {Points(count, 3), Points(count, 3)};
  NearestPoint at = {order[0], 0, Vector3::UnitX()};
  std::size_t next = 0;
  double u = 0.5, v = 0.5;  // the sequence of M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018
  double end = areas[at.face];
  for (int k = 0; k < count; ++k) {
    while (next + 1 < order.size() && end <= step * (k + 0.5)) {
      at.face = order[++next];
      end += areas[at.face];
    }
    u = std::fmod(u + 0.75487766624669276, 1);
    v = std::fmod(v + 0.56984029099805327, 1);
    if (!cloud) {
      const Vector3 weights = u + v > 1 ? Vector3(u + v - 1, 1 - u, 1 - v) : Vector3(1 - u - v, u, v);
      const std::array<int, 3> corners = corners_along(points_, faces_, at.face, oblique);
      for (int c = 0; c < 3; ++c) {
        at.weights[corners[c]] = weights[c];
      }
    }
    samples.points.row(k) = position(at).transpose();
    samples.normals.row(k) = normal(at).normalized().transpose();
  }
  return samples;
}

}  // namespace lapedit
