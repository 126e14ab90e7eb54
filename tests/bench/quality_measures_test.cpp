// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/quality_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "shapes.h"
#include "support.h"

namespace quality {
namespace {

using lapedit::Points;
using lapedit::TriangleMesh;
using lapedit::Vector3;
namespace shapes = lapedit::shapes;
namespace support = lapedit::support;

std::vector<int> all_faces(const TriangleMesh& mesh) {
  std::vector<int> faces(mesh.faces.rows());
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

int flipped(const TriangleMesh& mesh, const Points& after) {
  return flipped_triangles(support::adjacency_of(mesh), mesh.faces, all_faces(mesh), mesh.vertices, after);
}

TEST(QualityMeasures, RigidMotionStretchesFlipsAndFillsNothing) {
  const auto map = support::rigid(170, Vector3(1, 2, -1), Vector3(5, -3, 2));
  for (const TriangleMesh& mesh : {shapes::tapered_arm(24, 40), shapes::bumpy_grid(), shapes::degenerate_grid(12, 9),
                                   shapes::non_manifold_grid(9, 9)}) {
    const Points after = support::moved(map, mesh.vertices);
    const Stretch stretch = edge_stretch(support::whole_region(mesh, {{0}}, {1}), mesh.vertices, after);
    EXPECT_LT(stretch.rms, 1e-6);  // an edge of 1e-7 loses digits
    EXPECT_LT(stretch.largest, 1e-6);
    EXPECT_EQ(flipped(mesh, after), 0);
  }
  const TriangleMesh ball = shapes::icosphere(3);
  EXPECT_NEAR(volume_change(ball.faces, all_faces(ball), ball.vertices, support::moved(map, ball.vertices)), 0, 1e-12);
}

TEST(QualityMeasures, StretchIsOfLengthsAndOnlyTheRegions) {
  const TriangleMesh mesh = shapes::grid(6, 6);
  Points after = mesh.vertices;
  after.col(0) *= 1.5;
  after.col(1) *= 1.5;
  const Stretch stretch = edge_stretch(support::whole_region(mesh, {{0}}, {35}), mesh.vertices, after);
  EXPECT_NEAR(stretch.rms, 0.5, 1e-12);
  EXPECT_NEAR(stretch.largest, 0.5, 1e-12);
  EXPECT_NEAR(edge_stretch(support::whole_region(mesh, {{0}}, {35}), after, mesh.vertices).largest, 0, 1e-12)
      << "shorter is not stretched";

  lapedit::RegionSpec spec;
  spec.radius = 2.1;
  const lapedit::Region corner = lapedit::build_region(mesh, support::adjacency_of(mesh), spec, {{0}});
  after = mesh.vertices;
  after.row(35) *= 7;
  EXPECT_EQ(edge_stretch(corner, mesh.vertices, after).rms, 0) << "far from the region";
  const std::vector<int> touched = region_faces(support::adjacency_of(mesh), corner);
  EXPECT_LT(touched.size(), all_faces(mesh).size());
  EXPECT_EQ(touched.front(), 0);
}

TEST(QualityMeasures, AVertexPulledAcrossItsRingFlipsTwoFaces) {
  const TriangleMesh mesh = shapes::grid(9, 9);
  Points after = mesh.vertices;
  after.row(9 * 4 + 4) += Vector3(1.3, 0, 0).transpose();  // over the edges of two faces of its ring
  EXPECT_EQ(flipped(mesh, after), 2);
  // Wherever the surface has been turned to.
  EXPECT_EQ(flipped(mesh, support::moved(support::rigid(120, Vector3(1, 1, 0), Vector3(1, 0, 0)), after)), 2);
}

TEST(QualityMeasures, BendingFlipsNothingThoughNormalsTurnOver) {
  const TriangleMesh mesh = shapes::grid(60, 9);
  Points after = mesh.vertices;
  for (Eigen::Index v = 0; v < after.rows(); ++v) {
    const double angle = mesh.vertices(v, 0) / 59 * std::acos(-1.0);
    after.row(v) << 59 / std::acos(-1.0) * std::sin(angle), mesh.vertices(v, 1),
        59 / std::acos(-1.0) * (1 - std::cos(angle));
  }
  EXPECT_EQ(flipped(mesh, after), 0);
}

TEST(QualityMeasures, VolumeOfAPartIsBelowItsBorder) {
  const TriangleMesh arm = shapes::cylinder(48, 41);
  std::vector<int> half;
  for (int f = 0; f < arm.faces.rows(); ++f) {
    if (arm.vertices(arm.faces(f, 0), 0) > 1.99 && arm.vertices(arm.faces(f, 1), 0) > 1.99 &&
        arm.vertices(arm.faces(f, 2), 0) > 1.99) {
      half.push_back(f);
    }
  }
  Points longer = arm.vertices;
  for (Eigen::Index v = 0; v < longer.rows(); ++v) {
    longer(v, 0) = 2 + std::max(longer(v, 0) - 2, 0.0) * 1.25;
  }
  EXPECT_NEAR(volume_change(arm.faces, half, arm.vertices, longer), 0.25, 1e-9);
  const TriangleMesh flat = shapes::grid(9, 9);
  EXPECT_TRUE(std::isnan(volume_change(flat.faces, all_faces(flat), flat.vertices, flat.vertices)));
}

}  // namespace
}  // namespace quality
