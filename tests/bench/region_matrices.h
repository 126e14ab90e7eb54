// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "quality_scene.h"

/// What peers share that solve on the region alone.
namespace quality {

/// The region as matrices; rows are local vertices.
struct RegionMatrices {
  Eigen::MatrixXd rest;
  Eigen::MatrixXi faces;
  Eigen::VectorXi held;
  Eigen::MatrixXd positions;  ///< where what is held has to be
};

RegionMatrices matrices_of(const Problem& scene);

/// Makes the next frame, from where the one before ended.
using NextFrame = std::function<void()>;

/// Prepares, then makes so many frames. @param prepare  gets the rest pose, which frames replace
MethodResult timed(const Problem& scene, int count,
                   const std::function<NextFrame(const RegionMatrices&, Eigen::MatrixXd&)>& prepare);

}  // namespace quality
