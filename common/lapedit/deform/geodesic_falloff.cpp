// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/geodesic_falloff.h"

#include <algorithm>

#include "lapedit/mesh/geodesic.h"

namespace lapedit {
namespace {

/// d_k^-3/2 over their sum; the first of those at no distance takes all, and nobody anything that none reaches.
Eigen::RowVectorXd shares(const Eigen::RowVectorXd& distances) {
  Eigen::Index first = 0;
  const double nearest = distances.minCoeff(&first);
  if (nearest == 0) {
    return Eigen::RowVectorXd::Unit(distances.size(), first);
  }
  if (nearest == kUnreached) {
    return Eigen::RowVectorXd::Zero(distances.size());
  }
  Eigen::RowVectorXd parts = nearest / distances.array();  // 0 for what does not reach here
  parts.array() *= parts.array().sqrt();
  return parts / parts.sum();
}

}  // namespace

Eigen::MatrixXd falloff_weights(const IndexLists& neighbours, const Points& points,
                                const std::vector<std::vector<int>>& seeds) {
  Eigen::MatrixXd result(neighbours.rows(), static_cast<Eigen::Index>(seeds.size()));
  GeodesicSearch search(neighbours, points);
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    search.run(seeds[k], kUnreached);
    for (int i = 0; i < neighbours.rows(); ++i) {
      result(i, static_cast<Eigen::Index>(k)) = search.distance(i);
    }
  }
  for (int i = 0; i < neighbours.rows(); ++i) {
    result.row(i) = shares(result.row(i));
  }
  return result.leftCols(result.cols() - 1);
}

GeodesicFalloff geodesic_falloff(const Region& region, const Points& points) {
  const int groups = 1 + *std::max_element(region.group.begin(), region.group.end());
  std::vector<std::vector<int>> seeds(groups + 1);  // the anchors come last
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      seeds[region.group[i]].push_back(i);
    } else if (region.classes[i] == VertexClass::Anchor) {
      seeds[groups].push_back(i);
    }
  }
  GeodesicFalloff result = {falloff_weights(region.neighbours, points, seeds), {}};
  for (int i = 0; i < region.size(); ++i) {  // also where they are in one place
    if (region.classes[i] != VertexClass::Free) {
      result.weights.row(i).setZero();
    }
    if (region.classes[i] == VertexClass::Handle) {
      result.weights(i, region.group[i]) = 1;
    }
  }
  for (int g = 0; g < groups; ++g) {
    result.lone.push_back(seeds[g].size() == 1 ? seeds[g][0] : -1);
  }
  return result;
}

}  // namespace lapedit
