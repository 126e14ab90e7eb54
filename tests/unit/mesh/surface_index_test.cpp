// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/surface_index.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "shapes.h"

namespace lapedit::surface_index_test {
namespace {

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
}  // namespace lapedit::surface_index_test
