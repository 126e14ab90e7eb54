// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/fit/align.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "lapedit/base/polar_decomposition.h"

namespace lapedit {
namespace {

/// Aligns surfaces with the trimmed iterative closest point method (D. Chetverikov et al. 2002). Pairs are in both
/// directions, so that a template with a free scale does not shrink into the scan. Each direction chooses which
/// fraction of its pairs overlaps.
class TrimmedIcp {
 public:
  TrimmedIcp(const SurfaceIndex& from, const Scan& scan, int samples, bool scaled, ThreadPool& pool)
      : surface_(from),
        scan_(scan.surface()),
        scaled_(scaled),
        pool_(pool),
        ours_(from.samples(samples, scan.axes())),
        theirs_(scan_.samples(samples, scan.axes())),
        hints_(static_cast<std::size_t>(ours_.points.rows() + theirs_.points.rows()), -1),
        distances_(hints_.size()) {}

  /// Makes at most `rounds` steps, fewer if one hardly changes the residual. @return the residual:
  /// the RMS distance of the nearest pairs, those of a small fraction counted as larger
  double run(SimilarityMap& map, int rounds) {
    constexpr double kConverged = 3e-3;
    double before = -1;
    for (int round = 0;; ++round) {
      report_progress(0, "align");
      const double residual = pair(map);
      if (round == rounds || std::abs(before - residual) < kConverged * residual) {
        return residual;
      }
      before = residual;
      map = point_to_plane_step(map, {from_, to_, normals_, weights_}, scaled_);
    }
  }

 private:
  double pair(const SimilarityMap& map) {
    constexpr int kGrain = 64;
    const int ours = static_cast<int>(ours_.points.rows()), all = static_cast<int>(hints_.size());
    from_.resize(all, 3);
    to_.resize(all, 3);
    normals_.resize(all, 3);
    for_indices(pool_, all, kGrain, [&](int k) {
      const bool forward = k < ours;
      const Vector3 point = (forward ? ours_.points.row(k) : theirs_.points.row(k - ours)).transpose();
      const SurfaceIndex& on = forward ? scan_ : surface_;
      int& hint = hints_[static_cast<std::size_t>(k)];
      const NearestPoint at = on.nearest(
          forward ? map(point) : Vector3(map.rotation.transpose() * (point - map.translation) / map.scale), hint);
      hint = at.face;
      from_.row(k) = (forward ? point : on.position(at)).transpose();
      to_.row(k) = (forward ? on.position(at) : point).transpose();
      normals_.row(k) = forward ? Eigen::RowVector3d(on.normal(at).transpose()) : theirs_.normals.row(k - ours);
      distances_[static_cast<std::size_t>(k)] = at.squared * (forward ? 1 : map.scale * map.scale);
    });
    weights_.setZero(all);
    return std::sqrt((trim(0, ours) + trim(ours, all - ours)) / 2);
  }

  /// Gives equal weights to the pairs of a range that overlap: the nearest 80 %, or fewer if their RMS distance over
  /// the square of their fraction is clearly smaller. @return their mean squared distance
  double trim(Eigen::Index first, Eigen::Index count) {
    constexpr double kMost = 0.8, kLeast = 0.25, kStep = 0.05, kClearly = 0.75 * 0.75;
    sorted_.assign(distances_.begin() + first, distances_.begin() + first + count);
    std::sort(sorted_.begin(), sorted_.end());
    Eigen::Index taken = 0, chosen = 0;
    double sum = 0, best = 0;
    for (double part = kLeast; part < kMost + kStep / 2; part += kStep) {
      const auto upto = static_cast<Eigen::Index>(part * static_cast<double>(count - 1)) + 1;
      for (; taken < upto; ++taken) {
        sum += sorted_[static_cast<std::size_t>(taken)];
      }
      const double ratio = kMost / part, value = sum / static_cast<double>(taken) * ratio * ratio * ratio * ratio;
      const bool last = part + kStep > kMost + kStep / 2;
      if (chosen == 0 || (last ? kClearly * value : value) <= best) {
        best = value;
        chosen = taken;
      }
    }
    if (chosen == taken) {  // nearly all overlaps, so the remaining pairs count a little: a row of teeth moved by one
      constexpr double kLittle = 0.01;
      best += kLittle * std::accumulate(sorted_.begin(), sorted_.end(), 0.0) / static_cast<double>(count);
    }
    const double most = sorted_[static_cast<std::size_t>(chosen - 1)];
    for (Eigen::Index k = first; k < first + count; ++k) {
      if (distances_[static_cast<std::size_t>(k)] <= most) {
        weights_[k] = 1 / static_cast<double>(count);
      }
    }
    return best;
  }

  const SurfaceIndex &surface_, &scan_;
  bool scaled_;
  ThreadPool& pool_;
  SurfaceSamples ours_, theirs_;
  std::vector<int> hints_;
  std::vector<double> distances_, sorted_;
  Points from_, to_, normals_;
  Eigen::VectorXd weights_;
};

/// Returns whether points do not lie nearly on a line.
bool spans_a_plane(const Points& points) {
  if (points.rows() < 3) {
    return false;
  }
  const Points centred = points.rowwise() - points.colwise().mean();
  const Eigen::JacobiSVD<Matrix3> svd(centred.transpose().lazyProduct(centred) / static_cast<double>(points.rows()));
  constexpr double kLine = 1e-4;  // squared
  return svd.singularValues()[1] > kLine * svd.singularValues()[0];
}

/// Returns the starts of the search: `in_place` if the sizes are similar, then maps that keep the centroids aligned:
/// one without a rotation, and four that rotate the template's principal axes to those of the scan.
std::vector<SimilarityMap> starts_of(const SurfaceIndex& from, const Scan& scan, const SimilarityMap& in_place,
                                     double scale) {
  Matrix3 mine = principal_axes(from.points(), from.faces());
  mine.col(2) *= mine.determinant() * scan.axes().determinant();
  std::vector<Matrix3> rotations = {Matrix3::Identity(), scan.axes() * mine.transpose()};
  for (int axis = 0; axis < 3; ++axis) {
    Vector3 signs = -Vector3::Ones();
    signs[axis] = 1;
    rotations.emplace_back(scan.axes() * signs.asDiagonal() * mine.transpose());
  }
  constexpr double kSimilar = 2;
  const double ratio = in_place.scale / scale;
  std::vector<SimilarityMap> starts;
  if (ratio < kSimilar && ratio > 1 / kSimilar) {
    starts.push_back(in_place);
  }
  for (const Matrix3& rotation : rotations) {
    starts.push_back({rotation, scale, Vector3::Zero()});
  }
  return starts;
}

/// Improves an alignment by few landmarks with the surfaces, unless these draw it away from the landmarks.
void improve(TrimmedIcp& surfaces, const Points& landmarks, const Points& targets, Alignment& by_landmarks) {
  constexpr int kRounds = 10;
  constexpr double kWorse = 1.5, kLittle = 0.01;
  SimilarityMap map = by_landmarks.map;
  const double residual = surfaces.run(map, kRounds);
  const auto distance = [&](const SimilarityMap& of) {
    return (of.all(landmarks) - targets).norm() / std::sqrt(static_cast<double>(landmarks.rows()));
  };
  if (distance(map) < kWorse * distance(by_landmarks.map) + kLittle) {
    by_landmarks.map = map;
    by_landmarks.residual = residual;
  }
}

}  // namespace

Alignment align(const SurfaceIndex& from, const Scan& scan, const SimilarityMap& in_place, const Points& landmarks,
                const Points& targets, FitAlign allowed, ThreadPool& pool) {
  constexpr int kFew = 400, kMany = 2000, kFirstRounds = 10, kRounds = 30;
  constexpr double kHopeless = 2;  // times the best residual
  const bool scaled = allowed == FitAlign::Similarity;
  Alignment best;
  TrimmedIcp fine(from, scan, kMany, scaled, pool);
  best.by_landmarks = allowed != FitAlign::None && spans_a_plane(landmarks);
  if (allowed == FitAlign::None || best.by_landmarks) {
    best.map = best.by_landmarks ? best_similarity(landmarks, targets, scaled ? 0 : in_place.scale) : in_place;
    best.residual = fine.run(best.map, 0);
    if (best.by_landmarks && scaled) {
      improve(fine, landmarks, targets, best);
    }
    return best;
  }
  const double scale = scaled ? 1 : in_place.scale;
  std::vector<SimilarityMap> maps = starts_of(from, scan, in_place, scale);
  std::vector<double> residuals(maps.size());
  TrimmedIcp coarse(from, scan, kFew, scaled, pool);
  constexpr std::size_t kWithoutPlace = 5;
  SimilarityMap place = in_place;
  const double unmoved = fine.run(place, 0);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    residuals[k] = coarse.run(maps[k], kFirstRounds);
  }
  const double most = kHopeless * *std::min_element(residuals.begin(), residuals.end());
  for (std::size_t k = 0; k < maps.size(); ++k) {
    if (residuals[k] <= most) {
      coarse.run(maps[k], kRounds);
      residuals[k] = fine.run(maps[k], kFirstRounds);
    }
  }
  const auto angle = [&maps](std::size_t k, const Matrix3& from) {  // the cosine
    return (maps[k].rotation.cwiseProduct(from).sum() - 1) / 2;
  };
  // A template often lies well: another orientation has to be clearly better, and so has another start of this one.
  constexpr double kClearly = 1.5, kInPlace = 0.7071, kSameRotation = 0.94;
  const auto best_of = [&](double cosine) {
    std::size_t found = maps.size();
    for (std::size_t k = 0; k < maps.size(); ++k) {
      if (angle(k, Matrix3::Identity()) >= cosine && (found == maps.size() || residuals[k] < residuals[found])) {
        found = k;
      }
    }
    return found;
  };
  std::size_t chosen = best_of(-1.5);
  for (const std::size_t k : {best_of(kInPlace), std::size_t{0}}) {
    if (k < maps.size() && angle(k, Matrix3::Identity()) >= kInPlace && residuals[k] <= kClearly * residuals[chosen]) {
      chosen = k;
    }
  }
  // A place that is nearly as good is kept: what is left may be the difference of the shapes.
  constexpr double kNearly = 3;
  const bool stays =
      maps.size() > kWithoutPlace && unmoved <= kNearly * *std::min_element(residuals.begin(), residuals.end());
  chosen = stays ? 0 : chosen;
  best.map = stays ? in_place : maps[chosen];
  best.residual = stays ? unmoved : residuals[chosen];
  Orientations& compared = best.orientations;
  compared.stayed = stays;
  const double unit = scan.size();
  compared.chosen = unit * residuals[chosen];
  for (std::size_t k = 0; k < maps.size(); ++k) {
    if (angle(k, maps[chosen].rotation) < kSameRotation) {
      compared.second = std::min(compared.second.value_or(unit * residuals[k]), unit * residuals[k]);
    }
  }
  Points image = -from.points();
  Faces faces = from.faces();
  faces.col(1).swap(faces.col(2));
  const SurfaceIndex mirrored(std::move(image), std::move(faces));
  TrimmedIcp other(mirrored, scan, kFew, scaled, pool);
  compared.mirrored = std::numeric_limits<double>::infinity();
  for (SimilarityMap& map : starts_of(mirrored, scan, in_place, scale)) {
    compared.mirrored = std::min(compared.mirrored, unit * other.run(map, kFirstRounds + kRounds));
  }
  return best;
}

}  // namespace lapedit
