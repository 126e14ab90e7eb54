// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/exchanged_targets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {
namespace {

using Order = std::vector<std::size_t>;  // the target of each point

/// Fits rigid motions with scale to targets in different orders. The order changes neither their mean nor their spread.
class Exchanges {
 public:
  Exchanges(std::vector<Vector3> points, std::vector<Vector3> targets)
      : points_(std::move(points)),
        targets_(std::move(targets)),
        spread_of_points_(centre(points_)),
        spread_of_targets_(centre(targets_)) {}

  bool spread() const { return spread_of_points_ > 0 && spread_of_targets_ > 0; }
  double spread_of_targets() const { return spread_of_targets_; }

  Matrix3 covariance(const Order& order) const {
    Matrix3 sum = Matrix3::Zero();
    for (std::size_t k = 0; k < points_.size(); ++k) {
      sum += targets_[order[k]] * points_[k].transpose();
    }
    return sum;
  }
  /// Returns the least sum of squared distances, |t|^2 - (R : C)^2 / |p|^2, where the rotation R is nearest to the
  /// covariance C.
  double distance(const Matrix3& covariance) const {
    const double along = std::max(nearest_rotation(covariance).cwiseProduct(covariance).sum(), 0.0);
    return std::max(spread_of_targets_ - along * along / spread_of_points_, 0.0);
  }
  void improve(Order& order, double& best) const;
  Order mirrored(std::size_t a, std::size_t b) const;

 private:
  /// Moves the centroid to the origin. @return the sum of squares
  static double centre(std::vector<Vector3>& points) {
    Vector3 mean = Vector3::Zero();
    for (std::size_t k = 0; k < points.size(); ++k) {
      mean += (points[k] - mean) / static_cast<double>(k + 1);
    }
    double sum = 0;
    for (Vector3& point : points) {
      point -= mean;
      sum += point.squaredNorm();
    }
    return sum;
  }

  std::vector<Vector3> points_, targets_;
  double spread_of_points_, spread_of_targets_;
};

/// Exchanges the pair of targets that reduces the distance most, and repeats this while it removes at least 30 %.
void Exchanges::improve(Order& order, double& best) const {
  constexpr double kMuch = 0.7;
  for (bool improved = true; improved;) {
    improved = false;
    const Matrix3 now = covariance(order);
    double least = kMuch * best;
    std::pair<std::size_t, std::size_t> pair;
    for (std::size_t b = 1; b < order.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        const Matrix3 change = (targets_[order[b]] - targets_[order[a]]) * (points_[a] - points_[b]).transpose();
        if (const double then = distance(now + change); then < least) {
          least = then;
          pair = {a, b};
          improved = true;
        }
      }
    }
    if (improved) {
      std::swap(order[pair.first], order[pair.second]);
      best = least;
    }
  }
}

/// Returns the order that exchanges all points that mirror each other at the plane between a and b.
Order Exchanges::mirrored(std::size_t a, std::size_t b) const {
  Order order(points_.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const Vector3 between = (points_[a] + points_[b]) / 2, normal = points_[a] - points_[b];
  const double squared = normal.squaredNorm();
  if (!(squared > 0)) {
    return order;
  }
  Order image(points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Vector3 there = points_[k] - 2 * normal.dot(points_[k] - between) / squared * normal;
    const auto nearest = std::min_element(points_.begin(), points_.end(), [&there](const Vector3& p, const Vector3& q) {
      return (p - there).squaredNorm() < (q - there).squaredNorm();
    });
    image[k] = static_cast<std::size_t>(nearest - points_.begin());
  }
  for (std::size_t k = 0; k < image.size(); ++k) {
    order[k] = image[image[k]] == k ? image[k] : k;
  }
  return order;
}

}  // namespace

ExchangedTargets find_exchanged_targets(const std::vector<Vector3>& points, const std::vector<Vector3>& targets) {
  constexpr std::size_t kFewest = 4, kMost = 60;
  constexpr double kBetter = 1.0 / 9, kFits = 0.15 * 0.15;  // ratios of squared distances
  ExchangedTargets result;
  const std::size_t count = points.size();
  const Exchanges all(points, targets);
  if (count < kFewest || count > kMost || !all.spread()) {
    return result;
  }
  Order given(count);
  std::iota(given.begin(), given.end(), std::size_t(0));
  const double distance = all.distance(all.covariance(given));
  if (!(distance > kFits / 9 * all.spread_of_targets())) {
    return result;  // the given order fits already
  }
  Order mirrored = given, pairs = given;
  double at_mirror = distance, at_pairs = distance;
  for (std::size_t b = 1; b < count; ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const Order order = all.mirrored(a, b);
      if (const double then = all.distance(all.covariance(order)); then < at_mirror) {
        at_mirror = then;
        mirrored = order;
      }
    }
  }
  all.improve(pairs, at_pairs);
  all.improve(mirrored, at_mirror);
  const Order& best = at_mirror < at_pairs ? mirrored : pairs;
  const double at_best = std::min(at_mirror, at_pairs);
  if (!(at_best < kBetter * distance && at_best < kFits * all.spread_of_targets())) {
    return result;
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (best[k] > k && best[best[k]] == k) {
      result.pairs.emplace_back(k, best[k]);
    }
  }
  result.given = std::sqrt(distance / static_cast<double>(count));
  result.exchanged = std::sqrt(at_best / static_cast<double>(count));
  return result;
}

}  // namespace lapedit
