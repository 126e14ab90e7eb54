// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/geodesic_falloff.h"

#include <algorithm>
#include <string>

#include "lapedit/base/refuse.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit {
namespace {

/// Returns d_k^-3/2 over their sum; the first one with distance zero gets the whole weight.
Eigen::RowVectorXd fractions(const Eigen::RowVectorXd& distances) {
  Eigen::Index first = 0;
  const double nearest = distances.minCoeff(&first);
  if (!(nearest > 0)) {
    return Eigen::RowVectorXd::Unit(distances.size(), first);
  }
  Eigen::RowVectorXd parts = nearest / distances.array();  // 0 for groups that do not reach this vertex
  parts.array() *= parts.array().sqrt();
  return parts / parts.sum();
}

}  // namespace

GeodesicFalloff geodesic_falloff(const Region& region, const Points& points) {
  const int groups = 1 + *std::max_element(region.group.begin(), region.group.end());
  constexpr double kMost = 1e8;  // distances, of 8 bytes
  if (static_cast<double>(groups) * region.size() > kMost) {
    refuse_edit(ErrorCause::BadParameter, {}, groups, " handle groups and ", region.size(),
                " region vertices are too many for the rough deformation \"falloff\", which needs a distance "
                "for each pair of them: use \"unrotated\", fewer groups or a smaller region.");
  }
  std::vector<std::vector<int>> seeds(groups + 1);  // the anchors come last
  const std::vector<double> largest = largest_weights(region);
  const auto is_handle = [&](int i) {
    return region.classes[i] == VertexClass::Handle && region.weight(i) == largest[region.group[i]];
  };
  for (int i = 0; i < region.size(); ++i) {
    if (is_handle(i)) {
      seeds[region.group[i]].push_back(i);
    } else if (region.classes[i] == VertexClass::Anchor) {
      seeds[groups].push_back(i);
    }
  }
  GeodesicFalloff result;
  result.lone = lone_vertices(region);
  Eigen::MatrixXd distances(region.size(), groups + 1);
  const CompressedRows around = build_adjacency(region.size(), region.faces).faces;
  GeodesicSearch search({region.neighbours, points, region.faces, around});
  for (int k = 0; k <= groups; ++k) {
    search.run(seeds[k], kUnreached);
    for (int i = 0; i < region.size(); ++i) {
      distances(i, k) = search.distance(i);
    }
    checkpoint(region.size());
  }
  result.weights.setZero(region.size(), groups);
  Checkpoints checkpoints;
  for (int i = 0; i < region.size(); ++i) {
    checkpoints(1 + groups);
    if (is_handle(i)) {
      result.weights(i, region.group[i]) = 1;
    } else if (region.classes[i] != VertexClass::Anchor) {
      result.weights.row(i) = fractions(distances.row(i)).head(groups);
    }
  }
  return result;
}

}  // namespace lapedit
