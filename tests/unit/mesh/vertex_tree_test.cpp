// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_tree.h"

#include <gtest/gtest.h>
#include <cmath>

#include <limits>
#include <random>

#include "lapedit/mesh/surface_index.h"
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

/// The distance to a triangle, by minimising over a fine grid of it.
double plain_distance(const Vector3& p, const Points& points, const Faces& faces) {
  constexpr int kSteps = 40;
  double best = std::numeric_limits<double>::max();
  for (const auto& face : faces.rowwise()) {
    const Vector3 a = points.row(face[0]), b = points.row(face[1]), c = points.row(face[2]);
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        best = std::min(best, (a + (b - a) * i / kSteps + (c - a) * j / kSteps - p).norm());
      }
    }
  }
  return best;
}

TEST(SurfaceIndex, FindsTheNearestPointBeforeAndAfterAMove) {
  TriangleMesh mesh = shapes::icosphere(1);
  SurfaceIndex surface(mesh.vertices, mesh.faces);
  ThreadPool pool(2);
  for (int pass = 0; pass < 2; ++pass) {
    int hint = -1;
    for (int k = 0; k < 60; ++k) {
      const Vector3 point(std::sin(1.7 * k) * 1.4, std::cos(2.3 * k) * 1.3, std::sin(0.9 * k + 1));
      const NearestPoint found = surface.nearest(point), hinted = surface.nearest(point, hint);
      const double plain = plain_distance(point, mesh.vertices, mesh.faces);
      EXPECT_LE(std::sqrt(found.squared), plain + 1e-12);
      EXPECT_GT(std::sqrt(found.squared), plain - 0.02);
      EXPECT_NEAR((surface.position(found) - point).squaredNorm(), found.squared, 1e-12);
      EXPECT_EQ(found.face, hinted.face);
      EXPECT_NEAR(found.weights.sum(), 1, 1e-12);
      hint = (7 * k) % static_cast<int>(mesh.faces.rows());
    }
    mesh.vertices.col(0) *= 1.6;
    mesh.vertices.col(1).array() += 0.4;
    surface.move(mesh.vertices, pool);
  }
}

TEST(SurfaceIndex, PointsWithoutFacesMayBeNan) {
  const TriangleMesh mesh = shapes::icosphere(3);
  Points points = Points::Constant(mesh.vertices.rows() + 1, 3, std::nan(""));
  points.bottomRows(mesh.vertices.rows()) = mesh.vertices;
  const SurfaceIndex sound(mesh.vertices, mesh.faces), surface(points, mesh.faces.array() + 1);
  for (int k = 0; k < 60; ++k) {
    const Vector3 point(std::sin(1.7 * k) * 1.4, std::cos(2.3 * k) * 1.3, std::sin(0.9 * k + 1));
    EXPECT_EQ(surface.nearest(point).face, sound.nearest(point).face);
    EXPECT_EQ(surface.nearest(point).squared, sound.nearest(point).squared);
  }
}

TEST(SurfaceIndex, TakesPointsAsFaces) {
  const Points points = shapes::icosphere(2).vertices;
  Faces faces(points.rows(), 3);
  for (int v = 0; v < points.rows(); ++v) {
    faces.row(v).setConstant(v);
  }
  const SurfaceIndex surface(points, faces, points);
  for (int k = 0; k < 40; ++k) {
    const Vector3 point(std::sin(1.7 * k), std::cos(2.3 * k), std::sin(0.9 * k + 1));
    Eigen::Index nearest = 0;
    (points.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
    EXPECT_EQ(surface.nearest(point).face, nearest);
  }
}

}  // namespace
}  // namespace lapedit::vertex_tree_test
