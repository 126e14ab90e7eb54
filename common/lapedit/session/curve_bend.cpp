// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/curve_bend.h"

#include <algorithm>

#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

/// Returns the weight of a point's displacement at a fraction of the path from its neighbour to the point.
/// @param free_point, free_neighbour  whether the point, or its neighbour, is an end of the curve
double rise(double fraction, bool free_point, bool free_neighbour) {
  if (free_point && free_neighbour) {
    return fraction;
  }
  return free_point       ? fraction * fraction
         : free_neighbour ? 1 - (1 - fraction) * (1 - fraction)
                          : fraction * fraction * (3 - 2 * fraction);
}

}  // namespace

std::vector<double> bend_weights(const TriangleMesh& mesh, const std::vector<int>& group, const HandleCurve& curve,
                                 int point) {
  const std::vector<int>& path = curve.path;
  std::vector<double> length(path.size(), 0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    length[i] = length[i - 1] + (position_of(mesh.vertices, path[i]) - position_of(mesh.vertices, path[i - 1])).norm();
  }
  const bool closed = path.front() == path.back();
  const int last = static_cast<int>(curve.points.size()) - 1;
  const auto is_free = [&](int k) { return !closed && (k == 0 || k == last); };
  std::vector<double> weights(group.size(), 0);
  const auto spread = [&](int k) {
    for (const int neighbour : {k - 1, k + 1}) {
      if (neighbour < 0 || neighbour > last) {
        continue;
      }
      const double to = length[curve.points[k]], from = length[curve.points[neighbour]];
      for (int i = std::min(curve.points[k], curve.points[neighbour]);
           i <= std::max(curve.points[k], curve.points[neighbour]); ++i) {
        const double fraction = to != from ? (length[i] - from) / (to - from) : i == curve.points[k] ? 1 : 0;
        if (const int at = index_in(group, path[i]); at >= 0) {
          weights[at] = std::max(weights[at], rise(fraction, is_free(k), is_free(neighbour)));
        }
      }
    }
  };
  spread(point);
  if (closed && (point == 0 || point == last)) {
    spread(last - point);
  }
  return weights;
}

int mirrored_point(const TriangleMesh& mesh, const HandleCurve& curve, int point, const Affine& mirror) {
  constexpr double kOfWay = 0.25;  // of the distance from the point to its image
  const Vector3 position = position_of(mesh.vertices, curve.path[curve.points[point]]), image = mirror * position;
  double nearest = kOfWay * (image - position).norm();
  int found = -1;
  for (int k = 0; k < static_cast<int>(curve.points.size()); ++k) {
    const double distance = (position_of(mesh.vertices, curve.path[curve.points[k]]) - image).norm();
    if (k != point && distance < nearest) {
      nearest = distance;
      found = k;
    }
  }
  return found;
}

}  // namespace lapedit
