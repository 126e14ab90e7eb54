// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/vertex_finder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"
#include "support.h"

namespace lapedit::vertex_finder_test {
namespace {

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

TEST(VertexFinder, FindsWhatComparingAllVerticesFinds) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const VertexFinder finder(mesh);
  for (int k = 0; k < 200; ++k) {
    const Vector3 point = 1.5 * Vector3(std::sin(1.0 * k), std::sin(2.3 * k), std::cos(1.7 * k));
    int nearest = 0;
    for (int v = 1; v < mesh.vertices.rows(); ++v) {
      const auto distance = [&](int w) { return (mesh.vertices.row(w).transpose() - point).squaredNorm(); };
      nearest = distance(v) < distance(nearest) ? v : nearest;
    }
    EXPECT_EQ(finder.anywhere(point, "Point").vertex, nearest) << k;
  }
  EXPECT_GE(finder.anywhere(Vector3(1e200, 0, 0), "Point").vertex, 0);
}

}  // namespace
}  // namespace lapedit::vertex_finder_test
