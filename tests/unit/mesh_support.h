// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <vector>

#include "base_support.h"
#include "lapedit/mesh/adjacency.h"
#include "lapedit/mesh/geodesic.h"
#include "shapes.h"

/// Meshes, renumbering, adjacency and distances for tests with meshes.
namespace lapedit::support {

/// The numbers below a count for which a condition holds.
template <typename Condition>
std::vector<int> where(Eigen::Index count, Condition holds) {
  std::vector<int> result;
  for (int i = 0; i < count; ++i) {
    if (holds(i)) {
      result.push_back(i);
    }
  }
  return result;
}

/// The mesh without the faces for whose centre a condition holds.
template <typename Condition>
TriangleMesh without_faces(TriangleMesh mesh, Condition holds) {
  const Faces all = mesh.faces;
  keep_faces(mesh.faces, [&](Eigen::Index f) {
    const Eigen::RowVector3d sum =
        mesh.vertices.row(all(f, 0)) + mesh.vertices.row(all(f, 1)) + mesh.vertices.row(all(f, 2));
    return !holds(Eigen::RowVector3d(sum / 3));
  });
  return mesh;
}

/// The same surface: vertex v gets the number new_number[v], faces another order and another first corner.
inline TriangleMesh renumbered(const TriangleMesh& mesh, const std::vector<int>& new_number, unsigned seed) {
  TriangleMesh result = mesh;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    result.vertices.row(new_number[v]) = mesh.vertices.row(v);
  }
  const std::vector<int> new_face = shuffled(static_cast<int>(mesh.faces.rows()), seed);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      result.faces(new_face[f], (k + f) % 3) = new_number[mesh.faces(f, k)];
    }
  }
  return result;
}

/// @param coordinates  three for each vertex; @param corners  three for each face
inline TriangleMesh mesh_of(const std::vector<double>& coordinates, const std::vector<int>& corners) {
  return {Eigen::Map<const Points>(coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3),
          Eigen::Map<const Faces>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3)};
}

inline Adjacency adjacency_of(const TriangleMesh& mesh) {
  return build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
}

/// Distances on a surface by trying all edges and all lines of SurfaceLines again and again (Bellman and Ford), without
/// what a search skips.
/// @param with_lines  or along edges alone
inline std::vector<double> plain_distances(const TriangleMesh& mesh, const std::vector<int>& seeds,
                                           bool with_lines = true) {
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
    if (!with_lines) {
      continue;
    }
    surface.from(
        v, 0, nullptr, [](int) { return kUnreached; },
        [&](int end, double length) {
          lines.push_back({v, end, length});
        });
  }
  std::vector<double> distance(n, kUnreached);
  for (const int seed : seeds) {
    distance[seed] = 0;
  }
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

/// Expects that a search finds what trying all edges, and lines, finds.
inline void expect_plain_distances(const TriangleMesh& mesh, bool with_lines) {
  const Adjacency adjacency = adjacency_of(mesh);
  GeodesicSearch search(with_lines ? PathGraph(mesh, adjacency) : PathGraph(adjacency.neighbours, mesh.vertices));
  for (const std::vector<int>& seeds : {std::vector<int>{0}, {3, 40, 41}, {17}}) {
    search.run(seeds, kUnreached);
    const std::vector<double> expected = plain_distances(mesh, seeds, with_lines);
    for (int v = 0; v < mesh.vertices.rows(); ++v) {
      const bool is_reached = expected[v] < kUnreached;
      ASSERT_NEAR(is_reached ? search.distance(v) : 0, is_reached ? expected[v] : 0, 1e-12 * (1 + expected[v]));
      ASSERT_EQ(search.distance(v) < kUnreached, is_reached) << "vertex " << v;
    }
  }
}

/// Meshes of all kinds.
inline std::vector<TriangleMesh> all_shapes() {
  return {shapes::letter_field(24, 16),
          shapes::icosphere(2),
          shapes::bar(7, 3, 2),
          shapes::tapered_arm(12, 30),
          shapes::two_pieces(2),
          shapes::degenerate_grid(12, 9),
          shapes::non_manifold_grid(12, 9),
          shapes::inconsistent_grid(14, 11)};
}

}  // namespace lapedit::support
