// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/align.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {
namespace {

constexpr double kTrimmed = 0.8;  // the nearest part of all pairs that counts

/// Returns the second moments of points about their mean.
Matrix3 moments(const Points& points) {
  const Points centred = points.rowwise() - points.colwise().mean();
  return centred.transpose().lazyProduct(centred) / static_cast<double>(points.rows());
}

/// Principal axes as columns, the longest first; right-handed.
Matrix3 principal_axes(const Points& points) {
  const Eigen::JacobiSVD<Matrix3> svd(moments(points), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 axes = svd.matrixU();
  if (axes.determinant() < 0) {
    axes.col(2) = -axes.col(2);
  }
  return axes;
}

/// Iterates closest points in both directions, so that a template with a free scale does not shrink into the scan.
class TrimmedIcp {
 public:
  TrimmedIcp(const SurfaceShape& from, const SurfaceTree& from_tree, const Scan& scan, int samples, bool scaled)
      : tree_(from_tree),
        scan_(scan),
        scaled_(scaled),
        ours_(samples_of(from, samples)),
        theirs_(samples_of(scan.surface(), samples)),
        ours_hints_(ours_.at.size(), -1),
        theirs_hints_(theirs_.at.size(), -1) {}

  /// @return the RMS distance of the nearest pairs
  double run(SimilarityMap& map, int rounds) {
    constexpr double kStill = 1e-10;  // squared
    double residual = 0;
    for (int round = 0; round <= rounds; ++round) {
      residual = pair(map);
      if (round == rounds) {
        break;
      }
      const SimilarityMap better = improved(map);
      const double change = (better.rotation - map.rotation).squaredNorm() +
                            (better.translation - map.translation).squaredNorm() +
                            (better.scale / map.scale - 1) * (better.scale / map.scale - 1);
      map = better;
      if (change < kStill) {
        break;
      }
    }
    return residual;
  }

 private:
  double pair(const SimilarityMap& map) {
    const Eigen::Index ours = ours_.points.rows(), theirs = theirs_.points.rows();
    from_.resize(ours + theirs, 3);
    to_.resize(ours + theirs, 3);
    normals_.resize(ours + theirs, 3);
    weights_.setZero(ours + theirs);
    distances_.resize(static_cast<std::size_t>(ours + theirs));
    for (Eigen::Index k = 0; k < ours; ++k) {
      int& hint = ours_hints_[static_cast<std::size_t>(k)];
      const NearestPoint at = scan_.tree().nearest(map(ours_.points.row(k).transpose()), hint);
      hint = at.face;
      from_.row(k) = ours_.points.row(k);
      to_.row(k) = scan_.tree().position(at).transpose();
      normals_.row(k) = scan_.tree().interpolated(scan_.surface().normals, at).transpose();
      distances_[static_cast<std::size_t>(k)] = at.squared;
    }
    for (Eigen::Index k = 0; k < theirs; ++k) {
      int& hint = theirs_hints_[static_cast<std::size_t>(k)];
      const Vector3 point = theirs_.points.row(k).transpose();
      const NearestPoint at = tree_.nearest(map.rotation.transpose() * (point - map.translation) / map.scale, hint);
      hint = at.face;
      from_.row(ours + k) = tree_.position(at).transpose();
      to_.row(ours + k) = point.transpose();
      normals_.row(ours + k) = theirs_.normals.row(k);
      distances_[static_cast<std::size_t>(ours + k)] = at.squared * map.scale * map.scale;
    }
    return std::sqrt((trim(0, ours) + trim(ours, theirs)) / 2);
  }

  /// Returns the map after a linear step that brings points to the planes of their partners, which slides along the
  /// surface where distances to points would hold it. Source: Y. Chen, G. Medioni, Object modelling by registration of
  /// multiple range images, IVC 1992.
  SimilarityMap improved(const SimilarityMap& map) const {
    constexpr double kDamping = 1e-6;
    Eigen::Matrix<double, 7, 7> matrix = Eigen::Matrix<double, 7, 7>::Zero();
    Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero(), row;
    for (Eigen::Index k = 0; k < from_.rows(); ++k) {
      if (weights_[k] > 0) {
        const Vector3 normal = normals_.row(k).transpose(), here = map(Vector3(from_.row(k).transpose()));
        row << here.cross(normal), normal, scaled_ ? here.dot(normal) : 0;
        matrix += weights_[k] * row * row.transpose();
        right += weights_[k] * normal.dot(to_.row(k).transpose() - here) * row;
      }
    }
    matrix.diagonal().array() += kDamping * matrix.trace();
    const Eigen::Matrix<double, 7, 1> step = matrix.llt().solve(right);
    Matrix3 turn = Matrix3::Identity();
    turn << 1, -step[2], step[1], step[2], 1, -step[0], -step[1], step[0], 1;
    turn = polar_rotation(turn);
    const double scale = std::clamp(1 + step[6], 0.8, 1.25);
    return {turn * map.rotation, scale * map.scale, scale * (turn * map.translation) + step.segment<3>(3)};
  }

  /// Gives the nearest pairs of a range their weights. @return their mean squared distance
  double trim(Eigen::Index first, Eigen::Index count) {
    sorted_.assign(distances_.begin() + first, distances_.begin() + first + count);
    const auto last = static_cast<std::ptrdiff_t>(kTrimmed * static_cast<double>(count - 1));
    std::nth_element(sorted_.begin(), sorted_.begin() + last, sorted_.end());
    const double most = sorted_[static_cast<std::size_t>(last)];
    double sum = 0, weights = 0;
    for (Eigen::Index k = first; k < first + count; ++k) {
      if (distances_[static_cast<std::size_t>(k)] <= most) {
        weights_[k] = 1 / static_cast<double>(count);
        sum += distances_[static_cast<std::size_t>(k)];
        weights += 1;
      }
    }
    return sum / weights;
  }

  const SurfaceTree& tree_;
  const Scan& scan_;
  bool scaled_;
  SurfaceSamples ours_, theirs_;
  std::vector<int> ours_hints_, theirs_hints_;
  Points from_, to_, normals_;
  Eigen::VectorXd weights_;
  std::vector<double> distances_, sorted_;
};

/// Returns whether points are not on a line, nearly.
bool spans_a_plane(const Points& points) {
  if (points.rows() < 3) {
    return false;
  }
  const Eigen::JacobiSVD<Matrix3> svd(moments(points));
  constexpr double kLine = 1e-4;  // squared
  return svd.singularValues()[1] > kLine * svd.singularValues()[0];
}

/// The template's place, and the turns that take its principal axes to those of the scan.
std::vector<SimilarityMap> starts_of(const SurfaceSamples& ours, const SurfaceSamples& theirs, double scale) {
  std::vector<SimilarityMap> starts(1);
  const Vector3 from = ours.points.colwise().mean().transpose(), to = theirs.points.colwise().mean().transpose();
  const auto add = [&](const Matrix3& rotation) {
    starts.push_back({rotation, scale, to - scale * (rotation * from)});
  };
  add(Matrix3::Identity());
  const Matrix3 mine = principal_axes(ours.points), other = principal_axes(theirs.points);
  for (const int half_turn : {-1, 0, 1, 2}) {
    Vector3 signs = Vector3::Ones();
    if (half_turn >= 0) {
      signs = -signs;
      signs[half_turn] = 1;
    }
    add(other * signs.asDiagonal() * mine.transpose());
  }
  return starts;
}

}  // namespace

SimilarityMap best_similarity(const Points& from, const Points& to, bool scaled, const Eigen::VectorXd& weights) {
  const auto weight = [&weights](Eigen::Index i) { return weights.size() > 0 ? weights[i] : 1; };
  double total = 0, spread = 0;
  Vector3 middle = Vector3::Zero(), target = Vector3::Zero();
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    total += weight(i);
    middle += weight(i) * from.row(i).transpose();
    target += weight(i) * to.row(i).transpose();
  }
  middle /= total;
  target /= total;
  Matrix3 product = Matrix3::Zero();
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    const Vector3 p = from.row(i).transpose() - middle;
    product += weight(i) * (to.row(i).transpose() - target) * p.transpose();
    spread += weight(i) * p.squaredNorm();
  }
  SimilarityMap map;
  map.rotation = polar_rotation(product);
  const double along = map.rotation.cwiseProduct(product).sum();
  map.scale = scaled && spread > 0 && along > 0 ? along / spread : 1;
  map.translation = target - map.scale * (map.rotation * middle);
  return map;
}

Alignment align(const SurfaceShape& from, const Scan& scan, const Points& landmarks, const Points& targets,
                FitAlign allowed, ThreadPool& pool, const Progress& progress) {
  constexpr int kFew = 400, kMany = 2000, kFirstRounds = 10, kRounds = 30;
  constexpr double kHopeless = 2;  // times the best residual
  const bool scaled = allowed == FitAlign::Similarity;
  const SurfaceTree tree(from.points, from.faces);
  Alignment best;
  report_progress(progress, 0, "align");
  if (allowed == FitAlign::None) {
    best.residual = TrimmedIcp(from, tree, scan, kMany, false).run(best.map, 0);
    return best;
  }
  if (spans_a_plane(landmarks)) {
    best.by_landmarks = true;
    best.map = best_similarity(landmarks, targets, scaled);
    SimilarityMap unchanged = best.map;
    best.residual = TrimmedIcp(from, tree, scan, kMany, scaled).run(unchanged, 0);
    return best;
  }
  const double scale = scaled ? size_of(scan.surface()).size / size_of(from).size : 1;
  std::vector<SimilarityMap> maps = starts_of(samples_of(from, kMany), samples_of(scan.surface(), kMany), scale);
  std::vector<double> residuals(maps.size());
  const auto run_all = [&](int rounds, double most) {
    pool.each(static_cast<int>(maps.size()), [&](int k) {
      const auto at = static_cast<std::size_t>(k);
      if (residuals[at] <= most) {
        residuals[at] = TrimmedIcp(from, tree, scan, kFew, scaled).run(maps[at], rounds);
      }
    });
  };
  run_all(kFirstRounds, 0);
  run_all(kRounds, kHopeless * *std::min_element(residuals.begin(), residuals.end()));
  report_progress(progress, 0, "align");
  const auto chosen =
      static_cast<std::size_t>(std::min_element(residuals.begin(), residuals.end()) - residuals.begin());
  for (std::size_t k = 0; k < maps.size(); ++k) {
    constexpr double kSameTurn = 2.88;  // trace of a rotation by 20 degrees
    if (maps[k].rotation.cwiseProduct(maps[chosen].rotation).sum() < kSameTurn) {
      best.second = std::min(best.second.value_or(residuals[k]), residuals[k]);
    }
  }
  best.map = maps[chosen];
  const double before = residuals[chosen];
  best.residual = TrimmedIcp(from, tree, scan, kMany, scaled).run(best.map, kFirstRounds);
  if (best.second && before > 0) {
    *best.second *= best.residual / before;
  }
  return best;
}

}  // namespace lapedit
