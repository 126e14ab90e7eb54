// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/geodesic.h"

#include <algorithm>
#include <utility>

namespace lapedit {

void distance_contour(const TriangleMesh& mesh, const Adjacency& adjacency, const GeodesicSearch& search, double radius,
                      const std::vector<int>& reached, std::vector<double>& scratch, Points& segments) {
  scratch.clear();
  for (const int v : reached) {
    if (search.distance(v) > radius) {
      break;  // nearest first
    }
    for (const int f : adjacency.faces[v]) {
      double distance[3];
      int lowest = -1;
      for (int k = 0; k < 3; ++k) {
        const int corner = mesh.faces(f, k);
        distance[k] = search.distance(corner);
        if (distance[k] <= radius && (lowest < 0 || corner < lowest)) {
          lowest = corner;
        }
      }
      const int inside = static_cast<int>(std::count_if(distance, distance + 3, [&](double d) { return d <= radius; }));
      if (lowest != v || inside == 3) {
        continue;  // each face once, at its lowest corner inside
      }
      for (int k = 0; k < 3; ++k) {
        int from = k, to = (k + 1) % 3;
        if ((distance[from] <= radius) == (distance[to] <= radius)) {
          continue;
        }
        if (distance[from] > radius) {
          std::swap(from, to);
        }
        const Vector3 start = mesh.vertices.row(mesh.faces(f, from)), end = mesh.vertices.row(mesh.faces(f, to));
        // The distance of a vertex that the search did not reach is that along the edge.
        const double beyond = std::min(distance[to], distance[from] + (end - start).norm());
        const double fraction = beyond > distance[from] ? (radius - distance[from]) / (beyond - distance[from]) : 0;
        const Vector3 position = start + std::clamp(fraction, 0.0, 1.0) * (end - start);
        scratch.insert(scratch.end(), position.data(), position.data() + 3);
      }
    }
  }
  segments = Eigen::Map<const Points>(scratch.data(), static_cast<Eigen::Index>(scratch.size() / 3), 3);
}

}  // namespace lapedit
