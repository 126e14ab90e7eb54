// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/correspondences.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lapedit/fit/fit_constants.h"
#include "lapedit/mesh/adjacency.h"

namespace lapedit {
namespace {

constexpr int kGrain = 128;

/// Returns the weight of a pair: 1 up to the distance `full`, 0 from twice that distance, and 0 if it is rejected.
double weight_of(double distance, double full) {
  return distance < 0 ? 0 : std::clamp(2 - distance / full, 0.0, 1.0);
}

/// Returns whether an item is in a pseudorandom sample of the fraction `part`. A larger fraction gives a superset.
bool is_in_part(std::uint32_t item, double part) {
  item = (item ^ (item >> 16)) * 0x45d9f3bU;
  item = (item ^ (item >> 16)) * 0x45d9f3bU;
  return part >= 1 || (item ^ (item >> 16)) < part * 0x1p32;
}

}  // namespace

Correspondences::Correspondences(const Scan& scan, const SurfaceIndex& surface, std::vector<char> free, double distance,
                                 bool borders)
    : scan_(scan),
      surface_(surface),
      free_(std::move(free)),
      given_(distance),
      // about as many as the template has vertices; of a cloud more, since some of its points may lie on an inner side
      samples_(scan.surface().samples((scan.surface().is_cloud() ? 4 : 1) * static_cast<int>(surface.points().rows()),
                                      scan.axes())) {
  std::uint32_t rank = 0;
  rank_.resize(free_.size());
  for (const int v : order_by_position(surface.points() * scan.axes())) {
    rank_[static_cast<std::size_t>(v)] = rank++;
  }
  if (const Faces edges = borders ? border_edges(scan.surface().faces()) : Faces(); edges.rows() > 0) {
    border_ = std::make_unique<const SurfaceIndex>(scan.surface().points(), edges);
  }
  forward_.pairs.resize(free_.size());
  back_.pairs.resize(static_cast<std::size_t>(samples_.points.rows()));
}

/// Finds the partner of a point on the other surface.
void Correspondences::look(const SurfaceIndex& on, const Vector3& point, const Vector3& normal, Pair& pair) const {
  // A cloud has no border. Beyond its end the nearest point lies sideways: reject such pairs.
  constexpr double kSideways = 3;
  // The nearest point of a thin plate may be on its other side.
  constexpr double kPlate = 0.1;  // of the scan's size
  const bool to_scan = &on == &scan_.surface();
  pair.at = on.nearest(point, pair.at.face);
  if (!on.ends_at(pair.at) && !on.faces_along(pair.at, side_ * normal, kFit.cosine)) {
    const double nearest = pair.at.squared;
    pair.at = on.nearest_facing(point, side_ * normal, kFit.cosine, kPlate);
    pair.at.squared = nearest;
    if (pair.at.face < 0) {
      return;
    }
  }
  if (on.ends_at(pair.at)) {
    return;
  }
  const Vector3 other = side_ * on.normal(pair.at);
  const Vector3 offset = on.position(pair.at) - point, along = to_scan ? Vector3(other.normalized()) : normal,
                straight = along.dot(offset) * along;
  if (to_scan && scan_.spacing() > 0 && (offset - straight).norm() > kSideways * scan_.spacing()) {
    return;
  }
  pair.distance = offset.norm();
  pair.pull = (to_scan ? 1 : -1) * (kFit.tangential * offset + (1 - kFit.tangential) * straight);
}

/// Collects the distances of a direction, and computes the distance up to which its pairs count fully.
void Correspondences::gather(Direction& direction, double least) {
  std::vector<double>& distances = direction.distances;
  distances.clear();
  for (const Pair& pair : direction.pairs) {
    if (pair.distance >= 0) {
      distances.push_back(pair.distance);
    }
  }
  direction.full = given_ > 0 ? given_ : least;
  if (!(given_ > 0) && !distances.empty()) {
    const auto quantile = [&](double part) {
      const auto at = distances.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(distances.size() - 1));
      std::nth_element(distances.begin(), at, distances.end());
      return *at;
    };
    constexpr double kOthers = 4;  // times the median: these belong to another object
    const double most = std::min(quantile(kFit.most), kOthers * quantile(0.5));
    direction.full = std::max(kFit.times * most, least);
  }
  constexpr double kCounts = 0.5;
  distances.erase(std::remove_if(distances.begin(), distances.end(),
                                 [&](double d) { return weight_of(d, direction.full) < kCounts; }),
                  distances.end());
}

void Correspondences::update(double least, double part, ThreadPool& pool) {
  const int n = static_cast<int>(free_.size());
  for_indices(pool, n + static_cast<int>(back_.pairs.size()), kGrain, [&](int k) {
    const bool back = k >= n;
    const int at = back ? k - n : k;
    Pair& pair = (back ? back_ : forward_).pairs[static_cast<std::size_t>(at)];
    pair.distance = -1;
    if (!is_in_part(back ? static_cast<std::uint32_t>(at) : rank_[static_cast<std::size_t>(at)], part)) {
      return;
    }
    if (!back && free_[static_cast<std::size_t>(at)] != 0) {
      const Vector3 point = surface_.points().row(at).transpose();
      if (border_ && surface_.is_on_border(at)) {
        pair.at = border_->nearest(point, pair.at.face);
        pair.pull = border_->position(pair.at) - point;
        pair.distance = pair.pull.norm();
      } else {
        look(scan_.surface(), point, surface_.normals().row(at).transpose(), pair);
      }
    } else if (back) {
      look(surface_, samples_.points.row(at).transpose(), samples_.normals.row(at).transpose(), pair);
      for (int c = 0; c < 3; ++c) {
        if (pair.at.weights[c] != 0 && free_[static_cast<std::size_t>(surface_.faces()(pair.at.face, c))] == 0) {
          pair.distance = -1;
        }
      }
    }
  });
  gather(back_, least);
  gather(forward_, least);
  Eigen::VectorXd gathered = Eigen::VectorXd::Zero(n);
  Points means = Points::Zero(n, 3);
  for (const Pair& pair : back_.pairs) {
    const double weight = weight_of(pair.distance, back_.full);
    for (int c = 0; c < 3 && weight > 0; ++c) {
      const int v = surface_.faces()(pair.at.face, c);
      gathered[v] += weight * pair.at.weights[c];
      means.row(v) += weight * pair.at.weights[c] * pair.pull.transpose();
    }
  }
  weights_.setZero(n);
  pulls_.setZero(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Pair& pair = forward_.pairs[static_cast<std::size_t>(i)];
    const double ahead = weight_of(pair.distance, forward_.full), back = std::min(gathered[i], 1.0);
    if (ahead + back > 0) {
      pulls_.row(i) = (ahead * pair.pull.transpose() + means.row(i) / std::max(gathered[i], 1.0)) / (ahead + back);
    }
    weights_[i] = std::min(1.0, ahead + back) / part;
  }
}

double Correspondences::turn_normals(ThreadPool& pool) {
  const auto n = static_cast<int>(surface_.points().rows());
  Eigen::VectorXd cosines(n);
  for_indices(pool, n, kGrain, [&](int k) {
    const NearestPoint at = scan_.surface().nearest(surface_.points().row(k).transpose());
    cosines[k] = scan_.surface().normal(at).dot(surface_.normals().row(k));
  });
  const Eigen::Index same = (cosines.array() > kFit.cosine).count();
  const Eigen::Index reversed = (cosines.array() < -kFit.cosine).count();
  side_ = reversed > 2 * same && !scan_.is_outward() ? -1 : 1;
  return (side_ < 0 ? same : reversed) / std::max(1.0, static_cast<double>(same + reversed));
}

double Correspondences::uncovered() const {
  double sum = 0;
  for (const Pair& pair : back_.pairs) {
    sum += pair.at.squared;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, back_.pairs.size())));
}

double Correspondences::doubled(const Points& rest, double away, ThreadPool& pool) const {
  constexpr double kStretched = 3;
  Eigen::ArrayXi elsewhere = Eigen::ArrayXi::Zero(rest.rows());
  for_indices(pool, static_cast<int>(rest.rows()), kGrain, [&](int k) {
    if (const Pair& pair = forward_.pairs[static_cast<std::size_t>(k)]; pair.distance >= 0) {
      const NearestPoint at = surface_.nearest(scan_.surface().position(pair.at));
      Eigen::RowVector3d apart = -rest.row(k);
      for (int c = 0; c < 3; ++c) {
        apart += at.weights[c] * rest.row(surface_.faces()(at.face, c));
      }
      const double before = apart.norm(), after = (surface_.position(at) - surface_.points().row(k).transpose()).norm();
      elsewhere[k] = before > std::max(away, kStretched * after) ? 1 : 0;
    }
  });
  const auto paired =
      std::count_if(forward_.pairs.begin(), forward_.pairs.end(), [](const Pair& p) { return p.distance >= 0; });
  return elsewhere.sum() / std::max(1.0, static_cast<double>(paired));
}

double Correspondences::matched(bool back) const {
  const auto all = back ? static_cast<std::ptrdiff_t>(back_.pairs.size()) : std::count(free_.begin(), free_.end(), 1);
  return all > 0 ? static_cast<double>(distances(back).size()) / static_cast<double>(all) : 0;
}

}  // namespace lapedit
