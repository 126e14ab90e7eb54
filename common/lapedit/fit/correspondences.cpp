// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/correspondences.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lapedit/mesh/surface_measures.h"

namespace lapedit {
namespace {

constexpr int kGrain = 128;
constexpr double kCosine = 0.5;  // of 60 degrees

/// Returns the displacement along a normal, with a part of the rest of it.
Vector3 along_normal(const Vector3& displacement, const Vector3& normal) {
  return kTangential * displacement + (1 - kTangential) * normal.dot(displacement) * normal;
}

/// 1 up to a distance, 0 from twice that.
double weight_of(double distance, double full) {
  return std::clamp(2 - distance / full, 0.0, 1.0);
}

}  // namespace

Correspondences::Correspondences(const Scan& scan, SurfaceShape& surface, std::vector<char> free, double distance)
    : scan_(scan),
      surface_(surface),
      free_(std::move(free)),
      given_(distance),
      tree_(surface.points, surface.faces),
      samples_(samples_of(scan.surface(), static_cast<int>(surface.points.rows()))),
      forward_(free_.size()),
      back_(samples_.at.size()) {}

void Correspondences::look_forward(ThreadPool& pool) {
  // A cloud has no border, but beyond its end points are drawn sideways.
  constexpr double kSideways = 3;
  const double most_sideways = kSideways * scan_.spacing();
  for_indices(pool, static_cast<int>(forward_.size()), kGrain, [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    Pair& pair = forward_[at];
    pair.distance = -1;
    if (free_[at] == 0) {
      return;
    }
    const Vector3 point = surface_.points.row(i).transpose();
    pair.at = scan_.tree().nearest(point, pair.at.face);
    Vector3 normal = side_ * scan_.tree().interpolated(scan_.surface().normals, pair.at);
    const double length = normal.norm();
    if (scan_.surface().ends_at(pair.at) || !(length > 0) || normal.dot(surface_.normals.row(i)) < kCosine * length) {
      return;
    }
    normal /= length;
    const Vector3 offset = scan_.tree().position(pair.at) - point;
    if (scan_.is_cloud() && (offset - normal.dot(offset) * normal).norm() > most_sideways) {
      return;
    }
    pair.distance = std::sqrt(pair.at.squared);
    pair.pull = along_normal(offset, normal);
  });
}

void Correspondences::look_back(ThreadPool& pool) {
  for_indices(pool, static_cast<int>(back_.size()), kGrain, [&](int k) {
    Pair& pair = back_[static_cast<std::size_t>(k)];
    pair.distance = -1;
    const Vector3 point = samples_.points.row(k).transpose(), normal = side_ * samples_.normals.row(k).transpose();
    pair.at = tree_.nearest(point, pair.at.face);
    const Vector3 ours = tree_.interpolated(surface_.normals, pair.at);
    if (surface_.ends_at(pair.at) || !(ours.dot(normal) >= kCosine * ours.norm()) || !(ours.norm() > 0)) {
      return;
    }
    for (int c = 0; c < 3; ++c) {
      if (pair.at.weights[c] != 0 && free_[static_cast<std::size_t>(surface_.faces(pair.at.face, c))] == 0) {
        return;
      }
    }
    pair.distance = std::sqrt(pair.at.squared);
    pair.pull = along_normal(point - tree_.position(pair.at), normal);
  });
}

double Correspondences::full_distance(const std::vector<Pair>& pairs, double least) const {
  constexpr double kMost = 0.7, kTimes = 5;
  if (given_ > 0) {
    return given_;
  }
  std::vector<double> sorted;
  for (const Pair& pair : pairs) {
    if (pair.distance >= 0) {
      sorted.push_back(pair.distance);
    }
  }
  if (sorted.empty()) {
    return least;
  }
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(kMost * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), at, sorted.end());
  return std::max(kTimes * *at, least);
}

void Correspondences::update(double least, ThreadPool& pool) {
  constexpr double kCounts = 0.5;
  vertex_normals(surface_.points, surface_.faces, surface_.normals);
  tree_.refit(pool);
  look_forward(pool);
  look_back(pool);
  const Eigen::Index n = surface_.points.rows();
  distances_.clear();
  back_distances_.clear();
  Eigen::VectorXd gathered = Eigen::VectorXd::Zero(n);
  Points means = Points::Zero(n, 3);
  double full = full_distance(back_, least);
  for (const Pair& pair : back_) {
    const double weight = pair.distance < 0 ? 0 : weight_of(pair.distance, full);
    if (weight >= kCounts) {
      back_distances_.push_back(pair.distance);
    }
    for (int c = 0; c < 3 && weight > 0; ++c) {
      const int v = surface_.faces(pair.at.face, c);
      gathered[v] += weight * pair.at.weights[c];
      means.row(v) += weight * pair.at.weights[c] * pair.pull.transpose();
    }
  }
  full = full_distance(forward_, least);
  weights_.setZero(n);
  pulls_.setZero(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Pair& pair = forward_[static_cast<std::size_t>(i)];
    const double ahead = pair.distance < 0 ? 0 : weight_of(pair.distance, full);
    if (ahead >= kCounts) {
      distances_.push_back(pair.distance);
    }
    const double back = std::min(gathered[i], 1.0);
    if (ahead + back > 0) {
      Vector3 pull = Vector3::Zero();
      if (ahead > 0) {
        pull += ahead * pair.pull;
      }
      if (back > 0) {
        pull += back / gathered[i] * means.row(i).transpose();
      }
      pulls_.row(i) = pull.transpose() / (ahead + back);
      weights_[i] = std::min(1.0, ahead + back);
    }
  }
}

bool Correspondences::turn_normals(ThreadPool& pool) {
  vertex_normals(surface_.points, surface_.faces, surface_.normals);
  const int n = static_cast<int>(forward_.size());
  std::vector<double> agree(forward_.size());
  for_indices(pool, n, kGrain, [&](int i) {
    const NearestPoint at = scan_.tree().nearest(surface_.points.row(i).transpose());
    agree[static_cast<std::size_t>(i)] =
        scan_.tree().interpolated(scan_.surface().normals, at).dot(surface_.normals.row(i));
  });
  int same = 0, reversed = 0;
  for (const double cosine : agree) {
    same += cosine > kCosine ? 1 : 0;
    reversed += cosine < -kCosine ? 1 : 0;
  }
  side_ = reversed > 2 * same ? -1 : 1;
  return side_ < 0;
}

double Correspondences::matched(bool back) const {
  const auto all = back ? static_cast<std::ptrdiff_t>(back_.size()) : std::count(free_.begin(), free_.end(), 1);
  return all > 0 ? static_cast<double>(distances(back).size()) / static_cast<double>(all) : 0;
}

}  // namespace lapedit
