// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/visibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "drag_support.h"

namespace lapedit::visibility_test {
namespace {

const Vector3 kDown(0, 0, -1);

std::optional<SurfaceHit> first_hit(const TriangleMesh& mesh, const Ray& ray) {
  int face = -1;
  double nearest = kUnreached;
  for (int f = 0; f < static_cast<int>(mesh.faces.rows()); ++f) {
    const double distance = distance_along(mesh, ray, f);
    face = distance < nearest ? f : face;
    nearest = std::min(nearest, distance);
  }
  return face < 0 ? std::nullopt : std::optional(hit_of(mesh, ray, face, nearest));
}

/// Expects that each vertex is seen whose ray meets a face of it first. @return how many of the first are hidden
int hidden_by_all_faces(const TriangleMesh& mesh, const Camera& view, int first) {
  const Adjacency adjacency = support::adjacency_of(mesh);
  const Visibility visibility(mesh);
  int hidden = 0;
  for (int v = 0; v < static_cast<int>(mesh.vertices.rows()); ++v) {
    const Vector3 position = mesh.vertices.row(v).transpose(), toward = view.toward_viewer(position);
    const auto hit = first_hit(mesh, {position + 20 * toward, -toward});
    const bool expected = hit && (mesh.faces.row(hit->face).array() == v).any();
    EXPECT_EQ(visibility.sees(view, adjacency, v), expected) << v;
    hidden += v < first && !expected ? 1 : 0;
  }
  return hidden;
}

TEST(Visibility, IsThatOfLookingAtAllFaces) {
  const TriangleMesh balls = shapes::together(shapes::icosphere(3), shapes::icosphere(2), Vector3(0.4, 0.3, 2.5));
  const auto all = static_cast<int>(balls.vertices.rows());
  const int of_balls =
      hidden_by_all_faces(balls, support::view_from(Vector3(1, 2, 8), Vector3(0, 0, 1), Vector3::UnitY()), all);
  EXPECT_GT(of_balls, all / 2);
  EXPECT_LT(of_balls, all * 9 / 10);
  // Rays along an axis, in the planes of the boxes' sides, near the origin and where nothing is between two numbers.
  for (const double offset : {0.0, 1e9}) {
    TriangleMesh grids = shapes::together(shapes::grid(9, 9), shapes::grid(5, 17), Vector3(2, -4, 3));
    grids.vertices.leftCols<2>().array() += offset;
    EXPECT_EQ(hidden_by_all_faces(grids, support::view_from_above(grids.vertices), 1000), 5 * 9);
  }
  // Vertices that are not finite are not seen, and hide nothing.
  TriangleMesh torn = shapes::together(shapes::grid(15, 15), shapes::grid(15, 15), Vector3(0.1, 0.1, 3));
  const Camera view = support::view_from_above(torn.vertices);
  for (int v = 230; v < 450; v += 7) {
    torn.vertices(v, v % 3) = v % 2 == 0 ? std::numeric_limits<double>::quiet_NaN() : kUnreached;
  }
  const int under_holes = hidden_by_all_faces(torn, view, 225);
  EXPECT_GT(under_holes, 50);
  EXPECT_LT(under_holes, 200);
}

TEST(Visibility, DuplicatedVerticesDoNotHideEachOther) {
  TriangleMesh mesh = shapes::together(shapes::grid(8, 8), shapes::grid(8, 8), Vector3(7, 0, 0));  // a torn seam
  const Visibility visibility(mesh);
  const Camera view = support::view_from_above(mesh.vertices);
  const Adjacency adjacency = support::adjacency_of(mesh);
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    EXPECT_TRUE(visibility.sees(view, adjacency, v)) << v;
  }
}

/// The near plane cuts off what is before it, and what lies behind the viewer hides nothing.
TEST(Visibility, OfAViewerInsideTheMesh) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Adjacency adjacency = support::adjacency_of(sphere);
  const Camera view = support::view_from(Vector3(0, 0, 0.1), Vector3(0, 0, -0.9), Vector3::UnitY());
  const Visibility visibility(sphere);
  for (int v = 0; v < sphere.vertices.rows(); ++v) {
    EXPECT_EQ(visibility.sees(view, adjacency, v, -1), sphere.vertices(v, 2) < 0.1 - 0.01) << v;
    EXPECT_FALSE(visibility.sees(view, adjacency, v, 1)) << v;
  }
}

std::vector<int> brushed(const TriangleMesh& mesh, const Camera& view, const Vector2& pixel, double radius) {
  const auto hit = first_hit(mesh, view.ray(pixel));
  if (!hit) {
    return {};
  }
  return brushed_vertices(mesh, support::adjacency_of(mesh), Visibility(mesh), view, {*hit}, pixel, pixel,
                          radius / view.pixel_size(hit->point));
}

/// Also the surface that falls away from the viewer, and on each piece under the line.
TEST(Brush, PaintsABandAsWideAsItsCircle) {
  TriangleMesh mesh = shapes::together(shapes::grid(40, 20), shapes::grid(40, 20), Vector3(0, 20, 0));
  mesh.vertices.col(2) = 2 * mesh.vertices.col(0);
  const Camera view = support::view_from_above(mesh.vertices);
  const Adjacency adjacency = support::adjacency_of(mesh);
  const Visibility visibility(mesh);
  const Vector2 from = view.pixel(Vector3(20, 3, 40)), to = view.pixel(Vector3(20, 36, 40));
  std::vector<SurfaceHit> hits;
  for (const Vector2& pixel : {from, to}) {
    hits.push_back(*visibility.first_hit(view.ray(pixel)));
  }
  const double radius = 3.5 / view.pixel_size(Vector3(20, 20, 40));
  const std::vector<int> expected = support::vertices_where(mesh, [](const Vector3& p) {
    return std::hypot(p.x() - 20, std::max({3 - p.y(), p.y() - 36, 0.0})) <= 3.5;
  });
  EXPECT_EQ(brushed_vertices(mesh, adjacency, visibility, view, hits, from, to, radius), expected);
}

TEST(Brush, ReachesTheNearSideOnlyHoweverLargeItIs) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const Camera view = support::view_from(Vector3(0, 0, 6), Vector3::Zero(), Vector3::UnitY());
  const std::vector<int> set = brushed(sphere, view, Vector2(400, 300), 100);
  EXPECT_GT(set.size(), 800U);
  for (const int v : set) {
    EXPECT_GT(sphere.vertices(v, 2), 0);
  }
}

TEST(Brush, StopsAtWhatABumpHides) {
  TriangleMesh mesh = shapes::grid(60, 40);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = 12 * std::exp(-std::pow((mesh.vertices(v, 0) - 30) / 4, 2));
  }
  const Camera view = support::view_from(Vector3(-40, 20, 60), Vector3(30, 20, 0));
  const auto at = [](int row) { return 40 * row + 20; };
  const Vector3 position = mesh.vertices.row(at(20)).transpose();
  const std::vector<int> set = brushed(mesh, view, view.pixel(position), 100);
  const auto is_in = [&set](int v) { return std::binary_search(set.begin(), set.end(), v); };
  EXPECT_TRUE(is_in(at(2)));
  EXPECT_TRUE(is_in(at(29)));
  EXPECT_FALSE(is_in(at(32))) << "on the far slope";
  EXPECT_FALSE(is_in(at(38))) << "in its shadow";
  // Visible behind the shadow, but no visible way leads there.
  EXPECT_TRUE(Visibility(mesh).sees(view, support::adjacency_of(mesh), at(59)));
  EXPECT_FALSE(is_in(at(59)));
}

TEST(Brush, WorksOnTheInsideOfAnOpenSurface) {
  const TriangleMesh mesh = shapes::grid(20, 20);
  const Camera view = support::view_from(Vector3(10, 10, -30), Vector3(10, 10, 0), Vector3::UnitY());
  EXPECT_GT(brushed(mesh, view, view.pixel(Vector3(10, 10, 0)), 4).size(), 20U);
}

TEST(RayCast, RayThroughAVertexOrAnEdgeDoesNotSlipThrough) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Visibility faces(sphere);
  for (int v = 0; v < sphere.vertices.rows(); ++v) {
    const Vector3 position = sphere.vertices.row(v).transpose();
    const auto hit = faces.first_hit({3 * position, -position});
    ASSERT_TRUE(hit) << v;
    EXPECT_EQ(hit->vertex, v);
  }
  for (Eigen::Index f = 0; f < sphere.faces.rows(); ++f) {
    const Vector3 middle =
        (sphere.vertices.row(sphere.faces(f, 0)) + sphere.vertices.row(sphere.faces(f, 1))).transpose() / 2;
    const auto hit = faces.first_hit({3 * middle, -middle});
    ASSERT_TRUE(hit) << f;
    EXPECT_LT((hit->point - middle).norm(), 1e-6);
  }
}

TEST(RayCast, LooksAlongItsDirectionOfAnyLength) {
  const TriangleMesh mesh = shapes::grid(5, 5);
  for (const double length : {1e-6, 1.0, 1e6}) {
    const auto hit = Visibility(mesh).first_hit({Vector3(1.3, 1.6, 5), length * kDown});
    ASSERT_TRUE(hit);
    EXPECT_LT((hit->point - Vector3(1.3, 1.6, 0)).norm(), 1e-9);
    EXPECT_EQ(hit->vertex, 5 * 1 + 2);
  }
  EXPECT_FALSE(Visibility(mesh).first_hit({Vector3(1.3, 1.6, -5), kDown})) << "behind the ray";
  EXPECT_FALSE(Visibility(mesh).first_hit({Vector3(1.3, 1.6, std::numeric_limits<double>::quiet_NaN()), kDown}));
}

TEST(RayCast, LooksThroughBrokenTriangles) {
  TriangleMesh mesh = shapes::together(shapes::grid(5, 5), shapes::grid(5, 5), Vector3(0, 0, 1));
  mesh.vertices.bottomRows(25).setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto hit = Visibility(mesh).first_hit({Vector3(1.3, 1.6, 5), kDown});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.z(), 0, 1e-12);
  mesh.vertices.bottomRows(25).setConstant(1);  // all in one point
  EXPECT_TRUE(Visibility(mesh).first_hit({Vector3(1.3, 1.6, 5), kDown}));
}

}  // namespace
}  // namespace lapedit::visibility_test
