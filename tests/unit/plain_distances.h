// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/geodesic.h"

namespace lapedit::support {

/// Distances on a surface by trying all edges and all lines of SurfaceLines again and again (Bellman and Ford), without
/// what a search skips.
inline std::vector<double> plain_distances(const TriangleMesh& mesh, const std::vector<int>& seeds) {
  struct Line {
    int from, to;
    double length;
  };
  const int n = static_cast<int>(mesh.vertices.rows());
  const Adjacency adjacency = build_adjacency(n, mesh.faces);
  const SurfaceLines surface(mesh.vertices, mesh.faces, adjacency.faces);
  std::vector<Line> lines;
  for (int v = 0; v < n; ++v) {
    for (const int w : adjacency.neighbours[v]) {
      lines.push_back({v, w, (mesh.vertices.row(v) - mesh.vertices.row(w)).norm()});
    }
    surface.from(
        v, 0, kUnreached, nullptr, [](int) { return kUnreached; },
        [&](int end, double length, bool) {
          lines.push_back({v, end, length});
        });
  }
  std::vector<double> distance(n, kUnreached);
  for (const int seed : seeds) distance[seed] = 0;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [from, to, length] : lines) {
      if (distance[from] + length < distance[to]) {
        distance[to] = distance[from] + length;
        changed = true;
      }
    }
  }
  return distance;
}

}  // namespace lapedit::support
