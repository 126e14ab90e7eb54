// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/base/types.h"

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

/// Returns the map with the smallest weighted RMS distance to targets. @param scale  0: the best one
/// @param weights  not negative; none: 1. Source: S. Umeyama, Least-squares estimation of transformation parameters
/// between two point patterns, PAMI 1991.
SimilarityMap best_similarity(const Points& from, const Points& to, double scale = 0,
                              const Eigen::VectorXd& weights = {});

/// Points, and planes that they should get to: points of the planes, their normals, and weights of the pairs.
struct PointsToPlanes {
  const Points &from, &to, &normals;
  const Eigen::VectorXd& weights;
};

/// Returns the map after a linear step that brings mapped points to the planes of their partners, which slides along
/// the surface where distances to points would hold it. @param scaled  whether the scale may change. Source: Y. Chen,
/// G. Medioni, Object modelling by registration of multiple range images, IVC 1992.
SimilarityMap point_to_plane_step(const SimilarityMap& map, const PointsToPlanes& pairs, bool scaled);

}  // namespace lapedit
