// SPDX-License-Identifier: GPL-3.0-or-later
// Distances on real meshes against CGAL's exact ones.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include "lapedit/mesh/geodesic.h"
#include "mesh_loader.h"
#include "support.h"

namespace lapedit::geodesic_test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ExactMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using ExactPaths = CGAL::Surface_mesh_shortest_path<CGAL::Surface_mesh_shortest_path_traits<Kernel, ExactMesh>>;

/// Returns the vertices of a mesh nearest to one, which becomes vertex 0, with the faces between them. CGAL needs 7 GB
/// for the whole of igea.
TriangleMesh piece_around(const TriangleMesh& mesh, const Adjacency& adjacency, int centre, std::size_t count) {
  GeodesicSearch search({mesh, adjacency});
  const std::vector<int>& vertices = search.run({centre}, kUnreached, nullptr, count);
  std::vector<int> number(mesh.vertices.rows(), -1);
  TriangleMesh piece;
  piece.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    number[vertices[i]] = static_cast<int>(i);
    piece.vertices.row(static_cast<Eigen::Index>(i)) = mesh.vertices.row(vertices[i]);
  }
  std::vector<int> inside;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (number[mesh.faces(f, 0)] >= 0 && number[mesh.faces(f, 1)] >= 0 && number[mesh.faces(f, 2)] >= 0) {
      inside.push_back(f);
    }
  }
  piece.faces.resize(static_cast<Eigen::Index>(inside.size()), 3);
  for (std::size_t i = 0; i < inside.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      piece.faces(static_cast<Eigen::Index>(i), k) = number[mesh.faces(inside[i], k)];
    }
  }
  return piece;
}

/// Exact distances from vertex 0.
std::vector<double> exact_distances(const TriangleMesh& mesh) {
  ExactMesh exact;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    exact.add_vertex(Kernel::Point_3(mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)));
  }
  const auto index = [](int v) { return ExactMesh::Vertex_index(static_cast<ExactMesh::size_type>(v)); };
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    EXPECT_NE(exact.add_face(index(mesh.faces(f, 0)), index(mesh.faces(f, 1)), index(mesh.faces(f, 2))),
              ExactMesh::null_face());
  }
  ExactPaths paths(exact);
  paths.add_source_point(index(0));
  std::vector<double> distances;
  distances.reserve(static_cast<std::size_t>(mesh.vertices.rows()));
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    distances.push_back(paths.shortest_distance_to_source_points(index(v)).first);
  }
  return distances;
}

class DistanceOn : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Real, DistanceOn, ::testing::Values("bunny.ply", "igea.ply"));

TEST_P(DistanceOn, IsNearlyExact) {
  constexpr std::size_t kSmall = 1500, kLarge = 6000;
  const TriangleMesh mesh = real::load(GetParam());
  const Adjacency adjacency = support::adjacency_of(mesh);
  std::mt19937 random(3);
  double longest = 0, shortest = kUnreached;
  for (int sample = 0; sample < 24; ++sample) {
    int centre = 0;
    do {
      centre = static_cast<int>(random() % static_cast<unsigned>(mesh.vertices.rows()));
    } while (adjacency.neighbours[centre].size() == 0);
    const TriangleMesh piece = piece_around(mesh, adjacency, centre, sample == 0 ? kLarge : kSmall);
    const std::vector<double> exact = exact_distances(piece);
    const Adjacency around = support::adjacency_of(piece);
    GeodesicSearch search({piece, around});
    search.run({0}, kUnreached);
    for (int v = 1; v < piece.vertices.rows(); ++v) {
      if (exact[v] < 0) {
        EXPECT_EQ(search.distance(v), kUnreached) << "between the piece's faces none leads there";
        continue;
      }
      longest = std::max(longest, search.distance(v) / exact[v]);
      shortest = std::min(shortest, search.distance(v) / exact[v]);
    }
  }
  EXPECT_LE(longest, 1.085);
  EXPECT_GE(shortest, 1 - 1e-12);
}

}  // namespace
}  // namespace lapedit::geodesic_test
