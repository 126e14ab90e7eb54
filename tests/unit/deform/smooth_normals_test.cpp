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

Points scratch;  // of SmoothingKernel::apply()

using support::mean_edge;

constexpr std::size_t kNeverSampled = std::numeric_limits<std::size_t>::max();

Region whole(const TriangleMesh& mesh, int handle = 0) {
  return support::whole_region(mesh, {{handle}}, {});
}

TEST(VertexNormals, OppositeFacesCancelToZeroNotToNoise) {
  // Two faces of one edge folded onto each other, tilted so that nothing cancels bit for bit.
  TriangleMesh mesh;
  mesh.vertices.resize(4, 3);
  mesh.vertices << 0, 0, 0, 1, 0, 0, 0.3, 1, 0, 0.3, 1, 0;
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 1, 0, 3;
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

class KernelOn : public ::testing::TestWithParam<TriangleMesh (*)()> {};
INSTANTIATE_TEST_SUITE_P(Shapes, KernelOn,
                         ::testing::Values([] { return shapes::letter_field(14, 9); },
                                           [] { return shapes::icosphere(2); }, [] { return shapes::bar(5, 2, 3); },
                                           [] { return shapes::tapered_arm(10, 20); },
                                           [] { return shapes::degenerate_grid(12, 9); },
                                           [] { return shapes::non_manifold_grid(12, 9); },
                                           [] { return shapes::two_pieces(1); }));

TEST_P(KernelOn, SampledKernelIsNearTheExactOne) {
  const TriangleMesh mesh = GetParam()();
  const Region region = whole(mesh);
  Points exact, sampled;
  const double r = 6 * mean_edge(mesh);
  SmoothingKernel(region, mesh.vertices, r, 1, kNeverSampled).apply(mesh.vertices, exact, scratch);
  SmoothingKernel(region, mesh.vertices, r, 1, 1).apply(mesh.vertices, sampled, scratch);
  // Blending shifts a mean by less than the distance to the centres, r / 4, and mostly cancels; up to 0.11 r was seen.
  EXPECT_LT((exact - sampled).rowwise().norm().maxCoeff(), 0.15 * r);
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
