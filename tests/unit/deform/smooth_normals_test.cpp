// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/smooth_normals.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <vector>

#include "lapedit/mesh/surface_measures.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::smooth_normals_test {
namespace {

Region whole(const TriangleMesh& mesh, int handle = 0) {
  return support::whole_region(mesh, {{handle}}, {});
}

TEST(VertexNormals, OppositeFacesCancelToZeroNotToNoise) {
  // Two faces of one edge folded onto each other, tilted so that nothing cancels bit for bit.
  TriangleMesh mesh = support::mesh_of({0, 0, 0, 1, 0, 0, 0.3, 1, 0, 0.3, 1, 0}, {0, 1, 2, 1, 0, 3});
  mesh.vertices = support::moved(support::rigid(33, Vector3(1, 2, 3), Vector3(0.1, 0.2, 0.3)), mesh.vertices);
  Points normals;
  vertex_normals(mesh.vertices, mesh.faces, normals);
  EXPECT_EQ(Vector3(normals.row(0)), Vector3(0, 0, 0));
  EXPECT_NEAR(normals.row(2).norm(), 1, 1e-14);
}

TEST(VertexNormals, AreZeroWhereThereIsNoArea) {
  const TriangleMesh mesh = shapes::degenerate_grid(12, 9);
  Points normals;
  vertex_normals(mesh.vertices, mesh.faces, normals);
  ASSERT_TRUE(normals.allFinite());
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const bool isolated = v >= mesh.vertices.rows() - 5;
    EXPECT_NEAR(normals.row(v).norm(), isolated ? 0 : 1, 1e-12) << "vertex " << v;
  }
}

TEST(SmoothingKernel, SampledOneIsNearTheExactOne) {
  for (const TriangleMesh& mesh : support::all_shapes()) {
    const Region region = whole(mesh);
    Points exact, sampled, scratch;
    const double r = 6 * support::mean_edge(mesh);
    SmoothingKernel(region, mesh.vertices, r, 1, std::numeric_limits<std::size_t>::max())
        .apply(mesh.vertices, exact, scratch);
    SmoothingKernel(region, mesh.vertices, r, 1, 1).apply(mesh.vertices, sampled, scratch);
    // Blending shifts a mean by less than the distance to the centres, r / 4, and mostly cancels; up to 0.11 r was
    // seen.
    EXPECT_LT((exact - sampled).rowwise().norm().maxCoeff(), 0.15 * r);
  }
}

TEST(AutomaticNormalRadius, FollowsTheSizeOfTheModel) {
  const TriangleMesh mesh = shapes::letter_field(40, 20);
  const double radius = automatic_normal_radius(whole(mesh, 410), mesh.vertices);
  for (const double scale : {1e-9, 1e-3, 1e6}) {
    const TriangleMesh other = support::moved(Affine(Eigen::Scaling(scale)), mesh);
    EXPECT_NEAR(automatic_normal_radius(whole(other, 410), other.vertices) / (scale * radius), 1, 1e-12);
  }
}

TEST(AutomaticNormalRadius, CoversTheDetailButNotTheRegion) {
  // Bumps of 8 x 8 in a region that reaches 50 to both sides of the handle.
  const TriangleMesh bumpy = shapes::bumpy_grid();
  std::vector<int> handle;
  handle.reserve(60);
  for (int j = 0; j < 60; ++j) {
    handle.push_back(60 * 50 + j);
  }
  const double radius = automatic_normal_radius(support::whole_region(bumpy, {handle}, {}), bumpy.vertices);
  EXPECT_GT(radius, 8);
  EXPECT_LT(radius, 25);
  // A region of a few edges still has neighbours to smooth over.
  const TriangleMesh mesh = shapes::grid(20, 20);
  const Region small = support::region_of(mesh, support::within(2), {{210}});
  EXPECT_GT(automatic_normal_radius(small, support::rows(mesh.vertices, small.mesh_vertex)), 2);
}

TEST(AutomaticNormalRadius, IsPositiveWhereAllVerticesCoincide) {
  TriangleMesh mesh = shapes::grid(4, 4);
  mesh.vertices.setOnes();
  EXPECT_GT(automatic_normal_radius(whole(mesh), mesh.vertices), 0);
}

}  // namespace
}  // namespace lapedit::smooth_normals_test
