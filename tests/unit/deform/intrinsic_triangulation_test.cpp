// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/intrinsic_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "shapes.h"
#include "support.h"

namespace lapedit::intrinsic_triangulation_test {
namespace {

/// A plane sheet in uneven cells, each cut along a random diagonal.
TriangleMesh sheet(unsigned seed) {
  TriangleMesh mesh = shapes::grid(20, 20);
  std::mt19937 random(seed);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); f += 2) {
    if (random() % 2 == 0) {
      const int a = mesh.faces.row(f).minCoeff(), d = mesh.faces.row(f + 1).maxCoeff();
      mesh.faces.middleRows(f, 2) << a, a + 20, d, a, d, a + 1;
    }
  }
  random.seed(5);
  std::uniform_real_distribution<double> step(-0.2, 0.2);
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const bool inside = v / 20 % 19 > 0 && v % 20 % 19 > 0;
    mesh.vertices.row(v) += (inside ? 1 : 0) * Eigen::RowVector3d(step(random), step(random), 0);
  }
  return mesh;
}

double difference(const SurfaceLaplacian& a, const SurfaceLaplacian& b) {
  const auto dense = [](const SurfaceLaplacian& from) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(from.areas.size(), from.areas.size());
    for (int i = 0; i < from.neighbours.rows(); ++i) {
      for (int k = from.neighbours.offsets[i]; k < from.neighbours.offsets[i + 1]; ++k) {
        result(i, from.neighbours.values[k]) = from.weights[k];
      }
    }
    return result;
  };
  return std::max((dense(a) - dense(b)).cwiseAbs().maxCoeff(), (a.areas - b.areas).cwiseAbs().maxCoeff());
}

TEST(SurfaceLaplacian, DoesNotDependOnTheTriangulation) {
  const auto laplacian_of = [](const TriangleMesh& mesh) { return surface_laplacian(mesh.vertices, mesh.faces); };
  for (const unsigned seed : {1U, 2U, 3U}) {
    EXPECT_LT(difference(laplacian_of(sheet(seed)), laplacian_of(sheet(0))), 1e-4) << seed;
  }
}

TEST(SurfaceLaplacian, DoesNotDependOnTheOrientationOfFaces) {
  TriangleMesh mesh = shapes::icosphere(3);
  const SurfaceLaplacian expected = surface_laplacian(mesh.vertices, mesh.faces);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); f += 2) {
    std::swap(mesh.faces(f, 0), mesh.faces(f, 1));
  }
  EXPECT_LT(difference(surface_laplacian(mesh.vertices, mesh.faces), expected), 1e-9);
}

/// Caps and needles down to no area, and long faces on the border.
TEST(SurfaceLaplacian, AreasSumToTheSurfacesAndWeightsArePositiveWithSlivers) {
  for (const double height : {0.0, 1e-12, 1e-6, 1e-3, 0.1, 2.0}) {
    TriangleMesh mesh = shapes::grid(12, 12);
    for (int v = 0; v < mesh.vertices.rows(); ++v) {
      mesh.vertices(v, 1) *= v % 12 < 6 ? 1 : height;
    }
    double area = 0;
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      const Vector3 a = mesh.vertices.row(mesh.faces(f, 0)), b = mesh.vertices.row(mesh.faces(f, 1)),
                    c = mesh.vertices.row(mesh.faces(f, 2));
      area += 0.5 * (b - a).cross(c - a).norm();
    }
    const SurfaceLaplacian found = surface_laplacian(mesh.vertices, mesh.faces);
    EXPECT_NEAR(found.areas.sum() / area, 1, 0.01) << height;
    EXPECT_GE(found.areas.minCoeff(), 0) << height;
    ASSERT_FALSE(found.weights.empty());
    EXPECT_GT(*std::min_element(found.weights.begin(), found.weights.end()), 0) << height;
    for (int i = 0; i < found.neighbours.rows(); ++i) {
      for (int k = found.neighbours.offsets[i]; k < found.neighbours.offsets[i + 1]; ++k) {
        EXPECT_EQ(found.weights[k], found.weights[found.neighbours.entry(found.neighbours.values[k], i)]) << height;
      }
    }
  }
}

/// Where the corner opposite to a border is obtuse, the border has no weight, and the other two sides have the energy
/// of the function x. At a right angle these are the cotangent weights.
TEST(SurfaceLaplacian, FlatFacesAtABorderAreNotStiff) {
  const Faces face = (Faces(1, 3) << 0, 1, 2).finished();
  for (const double height : {0.45, 0.1, 1e-3}) {
    const Points corners = (Points(3, 3) << 0, 0, 0, 1, 0, 0, 0.4, height, 0).finished();
    const SurfaceLaplacian found = surface_laplacian(corners, face);
    ASSERT_EQ(found.neighbours[0].size(), 1) << height;
    ASSERT_EQ(found.neighbours[1].size(), 1) << height;
    EXPECT_NEAR(0.16 * found.weights[0] + 0.36 * found.weights[1], height / 2, 1e-4 * height);
  }
  const Points right = (Points(3, 3) << 0, 0, 0, 1, 0, 0, 0.5, 0.4999999, 0).finished();
  EXPECT_NEAR(surface_laplacian(right, face).weights[0], 0.5, 1e-5);
}

/// Three faces at an edge, a strip with a half turn, and all vertices at one place.
TEST(SurfaceLaplacian, TakesSurfacesThatAreNoManifolds) {
  const Points corners = (Points(6, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0.5, 0, 0, 1, 1, 1, 1).finished();
  const Faces book = (Faces(3, 3) << 0, 1, 2, 0, 1, 3, 1, 0, 4).finished();
  const Faces strip = (Faces(6, 3) << 0, 1, 2, 1, 2, 3, 2, 3, 4, 3, 4, 5, 4, 5, 1, 5, 1, 0).finished();
  for (const Faces& faces : {book, strip}) {
    const SurfaceLaplacian found = surface_laplacian(corners, faces);
    EXPECT_TRUE(found.areas.allFinite());
    EXPECT_GT(found.weights.size(), 4U);
    const SurfaceLaplacian none = surface_laplacian(Points::Zero(6, 3), faces);
    EXPECT_TRUE(none.areas.allFinite());
    for (const double weight : none.weights) {
      EXPECT_TRUE(std::isfinite(weight));
    }
  }
}

}  // namespace
}  // namespace lapedit::intrinsic_triangulation_test
