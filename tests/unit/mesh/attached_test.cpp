// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/connect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lapedit/mesh/geodesic.h"
#include "lapedit/mesh/visibility.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::attached_test {
namespace {

/// A ball of radius 1 with bumps of this height at some directions.
TriangleMesh bumpy_ball(int levels, const std::vector<Vector3>& directions, double height, double width = 0.15) {
  TriangleMesh mesh = shapes::icosphere(levels);
  for (auto vertex : mesh.vertices.rowwise()) {
    double r = 1;
    for (const Vector3& direction : directions) {
      const double angle = std::acos(std::clamp<double>(vertex.dot(direction.normalized()), -1, 1));
      r += height * std::exp(-std::pow(angle / width, 4));
    }
    vertex *= r;
  }
  return mesh;
}

/// A ball with a smaller one, which the first vertices of the mesh do not belong to.
TriangleMesh with_ball(const TriangleMesh& mesh, double radius, const Vector3& at, int levels = 2) {
  TriangleMesh ball = shapes::icosphere(levels);
  ball.vertices *= radius;
  return shapes::together(mesh, ball, at);
}

Region region_about(const TriangleMesh& mesh, const Vector3& at, const RegionSpec& spec) {
  return build_region(mesh, support::adjacency_of(mesh), spec, {{support::vertex_at(mesh, at)}});
}

bool has_all(const Region& region, int first, Eigen::Index end) {
  for (int v = first; v < end; ++v) {
    if (!std::binary_search(region.mesh_vertex.begin(), region.mesh_vertex.end(), v)) {
      return false;
    }
  }
  return true;
}

class Sizes : public testing::TestWithParam<std::tuple<int, double>> {
 protected:
  int levels() const { return std::get<0>(GetParam()); }
  double size() const { return std::get<1>(GetParam()); }
  TriangleMesh sized(TriangleMesh mesh) const {
    mesh.vertices *= size();
    return mesh;
  }
  RegionSpec spec(double radius) const {
    RegionSpec made = support::within(radius * size());
    made.tips = made.pieces = true;
    return made;
  }
};
INSTANTIATE_TEST_SUITE_P(Attached, Sizes, testing::Combine(testing::Values(4, 5), testing::Values(1e-3, 1.0, 400.0)));

TEST_P(Sizes, PieceThatIsEnclosedOrTouchesComesAlong) {
  const TriangleMesh head = shapes::icosphere(levels());
  const int own = static_cast<int>(head.vertices.rows());
  // The distance of the ball's middle from that of the head, its radius, and whether it belongs to what moves.
  const std::tuple<double, double, bool> balls[] = {
      {0.8, 0.15, true},    // enclosed, 0.05 below the surface
      {0.3, 0.1, true},     // deep
      {1.202, 0.2, true},   // outside, touches
      {1.5, 0.2, false},    // outside
      {-0.8, 0.15, false},  // at the other side
      {0.2, 0.75, false},   // large
  };
  for (const auto& [away, radius, belongs] : balls) {
    const TriangleMesh mesh = sized(with_ball(head, radius, away * Vector3::UnitZ()));
    RegionSpec given = spec(1.5);
    const Region region = region_about(mesh, size() * Vector3::UnitZ(), given);
    EXPECT_EQ(region.pieces, belongs ? 1 : 0) << away;
    EXPECT_EQ(has_all(region, own, mesh.vertices.rows()), belongs) << away;
    EXPECT_EQ(region.anchored.size(), 1U) << "one component";
    for (int i = 0; i < region.size(); ++i) {
      EXPECT_TRUE(region.mesh_vertex[i] < own || region.classes[i] == VertexClass::Free);
    }
    // Without the piece all is as before.
    given.pieces = false;
    const Region alone = region_about(mesh, size() * Vector3::UnitZ(), given);
    const std::vector<int> rest(region.mesh_vertex.begin(), region.mesh_vertex.begin() + alone.size());
    EXPECT_EQ(alone.mesh_vertex, rest);
    EXPECT_TRUE(std::equal(alone.classes.begin(), alone.classes.end(), region.classes.begin()));
    EXPECT_TRUE(std::equal(alone.distance.begin(), alone.distance.end(), region.distance.begin()));
  }
}

TEST_P(Sizes, AllEnclosedPiecesComeAlongHoweverMany) {
  TriangleMesh head = shapes::icosphere(levels());
  constexpr int kPieces = 200;
  for (int k = 0; k < kPieces; ++k) {
    head = with_ball(head, 0.01, Vector3(0.02 * (k % 20) - 0.2, 0.03 * (k / 20) - 0.15, 0.6));
  }
  EXPECT_EQ(region_about(sized(head), size() * Vector3::UnitZ(), spec(1.5)).pieces, kPieces);
}

TEST_P(Sizes, PieceOfAGivenSetComesAlongIfItIsWholeInIt) {
  const TriangleMesh head = shapes::icosphere(levels());
  const TriangleMesh mesh = sized(with_ball(head, 0.15, 0.8 * Vector3::UnitZ()));
  RegionSpec given = spec(1.5);
  given.kind = RegionSpec::Kind::Vertices;
  given.vertices = support::vertices_where(mesh, [&](const Vector3& p) { return p.z() > 0.2 * size(); });
  Region region = region_about(mesh, size() * Vector3::UnitZ(), given);
  EXPECT_EQ(region.pieces, 1);
  EXPECT_EQ(region.left_out, 0);
  given.vertices.pop_back();
  region = region_about(mesh, size() * Vector3::UnitZ(), given);
  EXPECT_EQ(region.pieces, 0);
  EXPECT_GT(region.left_out, 0);
}

TEST_P(Sizes, TipBeyondTheRadiusBelongsToTheRegion) {
  const Vector3 ear(1, 0, 1);
  const TriangleMesh mesh = sized(bumpy_ball(levels(), {ear}, 0.8));
  const int tip = support::vertex_at(mesh, 1.8 * size() * ear.normalized());
  RegionSpec given = spec(1.45);
  const Region region = region_about(mesh, size() * Vector3::UnitZ(), given);
  const int i = index_in(region.mesh_vertex, tip);
  ASSERT_GE(i, 0);
  EXPECT_EQ(region.classes[i], VertexClass::Free);
  given.tips = false;
  const Region alone = region_about(mesh, size() * Vector3::UnitZ(), given);
  EXPECT_FALSE(contains(alone.mesh_vertex, tip));
  // Only the ear is added, and the boundary of the head holds as before.
  for (const int v : without(region.mesh_vertex, alone.mesh_vertex)) {
    EXPECT_GT(mesh.vertices.row(v).norm(), 1.05 * size());
  }
  for (int k = 0; k < alone.size(); ++k) {
    const int there = index_in(region.mesh_vertex, alone.mesh_vertex[k]);
    EXPECT_TRUE(region.classes[there] == alone.classes[k] ||
                mesh.vertices.row(alone.mesh_vertex[k]).norm() > 1.05 * size());
  }
}

/// Between two equal ends neither is a tip: both hold.
TEST_P(Sizes, EndsOfASymmetricPieceAreNoTips) {
  TriangleMesh mesh = shapes::icosphere(levels());
  mesh.vertices.col(2) *= 3;
  mesh = sized(std::move(mesh));
  RegionSpec given = spec(1.8);
  const Region region = region_about(mesh, size() * Vector3::UnitX(), given);
  given.tips = false;
  EXPECT_EQ(region.mesh_vertex, region_about(mesh, size() * Vector3::UnitX(), given).mesh_vertex);
}

double protrusion_at(const TriangleMesh& mesh, int vertex, double smallest, double largest) {
  const Adjacency adjacency = support::adjacency_of(mesh);
  GeodesicSearch search({mesh, adjacency});
  const std::vector<int>& reached = search.run({vertex}, largest);
  double whole = 0;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    whole += area_normal(mesh, f).norm() / 2;
  }
  return protrusion_radius(mesh, adjacency, search, reached, smallest, largest, whole);
}

TEST_P(Sizes, ProtrusionEndsAtItsNeck) {
  for (const double height : {0.6, 1.0, 1.5}) {
    const TriangleMesh mesh = sized(bumpy_ball(levels() + 1, {Vector3::UnitZ()}, height, 0.2));
    const int tip = support::vertex_at(mesh, (1 + height) * size() * Vector3::UnitZ());
    const double found = protrusion_at(mesh, tip, 0.1 * size(), 3 * size());
    EXPECT_GT(found, 0.9 * height * size());
    EXPECT_LT(found, (height + 0.55) * size());
  }
}

TEST_P(Sizes, WhereNothingStandsOutThereIsNoProtrusion) {
  const TriangleMesh ball = sized(shapes::icosphere(levels()));
  EXPECT_EQ(protrusion_at(ball, 7, 0.1 * size(), 2.5 * size()), 0);
  TriangleMesh plane = shapes::grid(60, 60);
  plane.vertices *= size();
  for (const int vertex : {0, 30, 30 * 60 + 30}) {
    EXPECT_EQ(protrusion_at(plane, vertex, size(), 25 * size()), 0) << vertex;
  }
  const TriangleMesh bump = sized(bumpy_ball(levels(), {Vector3::UnitZ()}, 0.05));
  EXPECT_EQ(protrusion_at(bump, support::vertex_at(bump, 1.05 * size() * Vector3::UnitZ()), 0.1 * size(), 2 * size()),
            0);
}

}  // namespace
}  // namespace lapedit::attached_test
