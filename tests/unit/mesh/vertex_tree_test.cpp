// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_tree.h"

#include <gtest/gtest.h>
#include <cmath>

#include <random>

#include "shapes.h"
#include "support.h"

namespace lapedit::vertex_tree_test {
namespace {

int nearest_of_all(const Points& points, const std::vector<int>& vertices, const Vector3& position, double limit,
                   int odd) {
  int found = -1;
  double best = limit * limit;
  for (const int v : vertices) {
    const double squared = (points.row(v).transpose() - position).squaredNorm();
    if (v % 2 >= odd && (squared < best || (squared == best && (found < 0 || v < found)))) {
      best = squared;
      found = v;
    }
  }
  return found;
}

/// Clouds, planes, lines and lattices full of ties, from positions inside and far outside, with and without a limit.
TEST(VertexTree, FindsWhatLookingAtAllFinds) {
  std::mt19937 random(14);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (const Vector3& extent : {Vector3(1, 1, 1), Vector3(5, 1, 0), Vector3(0, 3, 0), Vector3(0, 0, 0)}) {
    for (const bool lattice : {false, true}) {
      Points points(500, 3);
      for (Eigen::Index i = 0; i < points.size(); ++i) {
        const double x = coordinate(random);
        points.data()[i] = (lattice ? std::round(3 * x) / 3 : x) * extent[i % 3];
      }
      const std::vector<int> vertices = [&] {
        std::vector<int> some = support::shuffled(500, 3);
        some.resize(400);
        return some;
      }();
      std::vector<int> labels(500);
      for (int v = 0; v < 500; ++v) {
        labels[v] = v % 2;
      }
      const VertexTree tree(points, vertices, &labels);
      for (int k = 0; k < 300; ++k) {
        const double far = k % 3 == 0 ? 4 : 1;
        Vector3 position(far * coordinate(random), far * coordinate(random), far * coordinate(random));
        position = lattice ? Vector3((2 * position).array().round() / 6) : position;
        EXPECT_EQ(tree.nearest(position), nearest_of_all(points, vertices, position, 1e100, 0));
        EXPECT_EQ(tree.nearest(position, 0.3), nearest_of_all(points, vertices, position, 0.3, 0));
        std::size_t looks = 0;
        const auto found = tree.nearest(
            position, 0.09, 0, [](int) { return true; }, looks);
        EXPECT_EQ(found.vertex, nearest_of_all(points, vertices, position, 0.3, 1));
        const auto odd = tree.nearest(
            position, 0.09, VertexTree::kNoLabel, [](int v) { return v % 2 == 1; }, looks);
        EXPECT_EQ(odd.vertex, found.vertex);
      }
    }
  }
  EXPECT_EQ(VertexTree(Points(0, 3), {}).nearest(Vector3(1, 2, 3)), -1);
}

TEST(VertexTree, StrayVerticesNearTheLargestNumberDoNoHarm) {
  for (const double far : {1e103, 1e154, 1e200, 1.7e308, 1e-308, 4e-324}) {
    for (const Vector3& at : {Vector3(1, 0, 0), Vector3(1, 1, 1), Vector3(-1, 1, 1e-9)}) {
      Points points(6, 3);
      points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, (far * at).transpose(), (-far * at).transpose();
      const std::vector<int> vertices = {0, 1, 2, 3, 4, 5};
      const VertexTree tree(points, vertices);
      for (int v = 0; v < 4; ++v) {
        const Vector3 position = points.row(v).transpose() + Vector3(0.2, 0.3, 0.1);
        EXPECT_EQ(tree.nearest(position), nearest_of_all(points, vertices, position, 1e150, 0)) << far;
      }
      EXPECT_EQ(tree.nearest(Vector3(far, far, far), 0.1), nearest_of_all(points, vertices, {far, far, far}, 0.1, 0));
    }
  }
}

TEST(NearestVertex, IsTheNearestThatHasAFace) {
  const TriangleMesh mesh = shapes::degenerate_grid(12, 9);  // five isolated vertices at z = 10
  EXPECT_EQ(nearest_vertex(mesh, Vector3(3.2, 4.1, 0.3)), 9 * 3 + 4);
  EXPECT_LT(nearest_vertex(mesh, Vector3(0, 0, 1.0)), 108);
}

TEST(NearestVertex, PointFarAwayOrNotANumberIsRefused) {
  TriangleMesh mesh = shapes::grid(11, 11);
  const double tenth = 0.1 * std::sqrt(200.0);
  EXPECT_EQ(nearest_vertex(mesh, Vector3(5, 5, 0.99 * tenth)), 60);
  support::expect_refusal(ErrorCause::BadParameter, [&] { nearest_vertex(mesh, Vector3(5, 5, 1.01 * tenth)); });
  support::expect_refusal(ErrorCause::NotFinite, [&] { nearest_vertex(mesh, Vector3(5, std::nan(""), 0)); });
  mesh.vertices(60, 0) = std::nan("");
  EXPECT_NE(nearest_vertex(mesh, Vector3(5, 5, 0)), 60);
}

}  // namespace
}  // namespace lapedit::vertex_tree_test
