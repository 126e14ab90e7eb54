// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/surface_pick.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "drag_support.h"

namespace lapedit {
namespace {

const Vector3 kDown(0, 0, -1);

TEST(SurfacePick, FindsTheNearestTriangleAndItsNearestCorner) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Vector3 toward = Vector3(1, 2, 3).normalized();
  const auto hit = first_hit(sphere, {5 * toward, -toward});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.dot(toward), 1, 0.01);
  EXPECT_EQ(hit->vertex, support::vertex_at(sphere, hit->point));
  EXPECT_TRUE((sphere.faces.row(hit->face).array() == hit->vertex).any());
  EXPECT_FALSE(first_hit(sphere, {5 * toward, toward}));
  EXPECT_FALSE(first_hit(sphere, {5 * toward, Vector3(3, 0, -1)}));
}

TEST(SurfacePick, HitsFromInsideToo) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const auto hit = first_hit(sphere, {Vector3::Zero(), Vector3(0, 0.1, 2)});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.norm(), 1, 0.01);
}

TEST(SurfacePick, RayThroughAVertexOrAnEdgeDoesNotSlipThrough) {
  const TriangleMesh sphere = shapes::icosphere(3);
  for (int v = 0; v < sphere.vertices.rows(); ++v) {
    const Vector3 place = sphere.vertices.row(v).transpose();
    const auto hit = first_hit(sphere, {3 * place, -place});
    ASSERT_TRUE(hit) << v;
    EXPECT_EQ(hit->vertex, v);
  }
  for (Eigen::Index f = 0; f < sphere.faces.rows(); ++f) {
    const Vector3 middle =
        (sphere.vertices.row(sphere.faces(f, 0)) + sphere.vertices.row(sphere.faces(f, 1))).transpose() / 2;
    const auto hit = first_hit(sphere, {3 * middle, -middle});
    ASSERT_TRUE(hit) << f;
    EXPECT_LT((hit->point - middle).norm(), 1e-6);
  }
}

TEST(SurfacePick, LooksThroughBrokenTriangles) {
  TriangleMesh mesh = shapes::together(shapes::grid(5, 5), shapes::grid(5, 5), Vector3(0, 0, 1));
  mesh.vertices.bottomRows(25).setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto hit = first_hit(mesh, {Vector3(1.3, 1.6, 5), kDown});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.z(), 0, 1e-12);
  mesh.vertices.bottomRows(25).setConstant(1);  // all in one point
  EXPECT_TRUE(first_hit(mesh, {Vector3(1.3, 1.6, 5), kDown}));
}

TEST(Visibility, IsTheBruteForceAnswer) {
  const TriangleMesh mesh = shapes::together(shapes::icosphere(3), shapes::icosphere(2), Vector3(0.4, 0.3, 2.5));
  const Adjacency adjacency = support::adjacency_of(mesh);
  const View view = support::view_from(Vector3(1, 2, 8), Vector3(0, 0, 1), Vector3::UnitY());
  const Visibility visibility(mesh);
  int seen = 0;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    // The first thing along the ray to the vertex is a face of it.
    const Vector3 place = mesh.vertices.row(v).transpose();
    const auto hit = first_hit(mesh, {place + 20 * view.toward_viewer(place), -view.toward_viewer(place)});
    ASSERT_TRUE(hit);
    const bool expected = (mesh.faces.row(hit->face).array() == v).any();
    EXPECT_EQ(visibility.sees(view, adjacency, v), expected) << v;
    seen += expected;
  }
  EXPECT_GT(seen, mesh.vertices.rows() / 10);
  EXPECT_LT(seen, mesh.vertices.rows() / 2);
}

TEST(Visibility, DuplicatedVerticesDoNotHideEachOther) {
  TriangleMesh mesh = shapes::together(shapes::grid(8, 8), shapes::grid(8, 8), Vector3(7, 0, 0));  // a torn seam
  const Visibility visibility(mesh);
  const View view = support::view_from_above(mesh.vertices);
  const Adjacency adjacency = support::adjacency_of(mesh);
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    EXPECT_TRUE(visibility.sees(view, adjacency, v)) << v;
  }
}

std::vector<int> brushed(const TriangleMesh& mesh, const View& view, const Vector2& pixel, double radius) {
  const auto hit = first_hit(mesh, view.ray(pixel));
  if (!hit) {
    return {};
  }
  return brushed_vertices(mesh, support::adjacency_of(mesh), Visibility(mesh), view, *hit, radius);
}

TEST(Brush, KeepsToItsRadiusAlongTheSurface) {
  const TriangleMesh mesh = shapes::grid(40, 40);
  const View view = support::view_from_above(mesh.vertices);
  const std::vector<int> set = brushed(mesh, view, view.pixel(Vector3(20, 20, 0)), 3);
  EXPECT_TRUE(std::is_sorted(set.begin(), set.end()));
  EXPECT_TRUE(std::binary_search(set.begin(), set.end(), 40 * 20 + 23));
  EXPECT_FALSE(std::binary_search(set.begin(), set.end(), 40 * 20 + 24));
}

TEST(Brush, ReachesTheNearSideOnlyHoweverLargeItIs) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const View view = support::view_from(Vector3(0, 0, 6), Vector3::Zero(), Vector3::UnitY());
  const std::vector<int> set = brushed(sphere, view, Vector2(400, 300), 100);
  EXPECT_GT(set.size(), 800U);
  for (const int v : set) {
    EXPECT_GT(sphere.vertices(v, 2), 0);
  }
}

/// A sheet folded over itself: its lower half lies under the upper one, a unit below.
TriangleMesh folded() {
  TriangleMesh mesh = shapes::grid(41, 10);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const double along = mesh.vertices(v, 0);
    if (along > 20) {
      mesh.vertices(v, 0) = 40 - along + 0.3;
      mesh.vertices(v, 2) = -1;
    }
  }
  return mesh;
}

TEST(Brush, DoesNotTouchWhatLiesBehind) {
  const TriangleMesh mesh = folded();
  const View view = support::view_from_above(mesh.vertices);
  const std::vector<int> set = brushed(mesh, view, view.pixel(Vector3(18.2, 5, 0)), 15);
  EXPECT_GT(set.size(), 50U);
  for (const int v : set) {
    EXPECT_EQ(mesh.vertices(v, 2), 0);
  }
}

TEST(Brush, WorksOnTheInsideOfAnOpenSurface) {
  const TriangleMesh mesh = shapes::grid(20, 20);
  const View view = support::view_from(Vector3(10, 10, -30), Vector3(10, 10, 0), Vector3::UnitY());
  EXPECT_GT(brushed(mesh, view, view.pixel(Vector3(10, 10, 0)), 4).size(), 20U);
}

}  // namespace
}  // namespace lapedit
