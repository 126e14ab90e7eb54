// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/fit/scan.h"

namespace lapedit {

/// p -> scale rotation p + translation
struct SimilarityMap {
  Matrix3 rotation = Matrix3::Identity();
  double scale = 1;
  Vector3 translation = Vector3::Zero();

  Vector3 operator()(const Vector3& p) const { return scale * (rotation * p) + translation; }
  Points all(const Points& points) const {
    return (scale * points * rotation.transpose()).rowwise() + translation.transpose();
  }
};

/// Returns the map with the smallest weighted RMS distance to targets. @param scaled  false: the scale is 1
/// @param weights  not negative; none: 1. Source: S. Umeyama, Least-squares estimation of transformation parameters
/// between two point patterns, PAMI 1991.
SimilarityMap best_similarity(const Points& from, const Points& to, bool scaled, const Eigen::VectorXd& weights = {});

/// What is allowed when a template is aligned with its scan before the fit.
enum class FitAlign {
  Similarity,  ///< translation, rotation and scale
  Rigid,       ///< translation and rotation
  None         ///< the template is in place
};

struct Alignment {
  SimilarityMap map;
  double residual = 0;           ///< RMS distance of the nearest 80 % both ways; the scan's size is 1
  std::optional<double> second;  ///< of the best other start that ends with another rotation
  bool by_landmarks = false;
};

/// Aligns a template with a scan, both in the scan's coordinates: by the landmarks if there are three that are not on a
/// line, otherwise from several starts by trimmed closest points in both directions.
/// @param landmarks, targets  of each its position on the template and on the scan
/// @throws EditError (Cancelled). Cost: about a tenth of a second.
Alignment align(const SurfaceShape& from, const Scan& scan, const Points& landmarks, const Points& targets,
                FitAlign allowed, ThreadPool& pool, const Progress& progress);

}  // namespace lapedit
