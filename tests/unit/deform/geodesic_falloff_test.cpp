// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/geodesic_falloff.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lapedit/deform/frame_rotations.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::geodesic_falloff_test {
namespace {

using Maps = std::vector<HandleMotion>;

/// A region of a bumpy grid with two handles, one of them a single vertex.
struct Scene {
  TriangleMesh mesh = shapes::bumpy_grid();
  std::vector<std::vector<int>> handles{{3030}, {2434, 2435, 2494, 2495}};
  Region region;
  Maps maps{support::shift(Vector3(1, 2, 6)),
            support::rigid(50, Vector3(1, 3, 1), Vector3(0, 1, 4), Vector3(41, 35, 0))};

  Scene() { region = support::region_of(mesh, support::within(12), handles); }
  Points rest() const { return support::rows(mesh.vertices, region.mesh_vertex); }
  std::vector<int> local(const std::vector<int>& vertices) const {
    return support::where(
        region.size(), [&](int i) { return std::count(vertices.begin(), vertices.end(), region.mesh_vertex[i]) > 0; });
  }
};

TEST(GeodesicFalloff, IsInverseDistancesToThePowerOfThreeHalves) {
  const Scene scene;
  const Region& region = scene.region;
  const TriangleMesh surface{scene.rest(), region.faces};
  const std::vector<int> anchors =
      support::where(region.size(), [&](int i) { return region.classes[i] == VertexClass::Anchor; });
  const std::vector<double> first = support::plain_distances(surface, scene.local(scene.handles[0])),
                            second = support::plain_distances(surface, scene.local(scene.handles[1])),
                            boundary = support::plain_distances(surface, anchors);
  const GeodesicFalloff falloff = geodesic_falloff(region, surface.vertices);
  ASSERT_EQ(falloff.weights.cols(), 2);
  EXPECT_EQ(falloff.lone, (std::vector<int>{scene.local({3030})[0], -1}));
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Free) {
      const double a = std::pow(first[i], -1.5), b = std::pow(second[i], -1.5), c = std::pow(boundary[i], -1.5);
      EXPECT_NEAR(falloff.weights(i, 0), a / (a + b + c), 1e-12);
      EXPECT_NEAR(falloff.weights(i, 1), b / (a + b + c), 1e-12);
    } else {
      EXPECT_EQ(falloff.weights(i, 0), region.group[i] == 0);
      EXPECT_EQ(falloff.weights(i, 1), region.group[i] == 1);
    }
  }
}

TEST(GeodesicFalloff, WeightsOfGroupsAddUpToOneWithoutAnchors) {
  const TriangleMesh mesh = shapes::two_pieces();
  const int n = static_cast<int>(mesh.vertices.rows());
  const Region region = support::whole_region(mesh, {{0}, {11}, {n - 1}}, {});
  const Eigen::MatrixXd weights = geodesic_falloff(region, mesh.vertices).weights;
  EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-15);
  for (int i = 0; i < n; ++i) {  // the other piece's handle does not reach here
    EXPECT_EQ(weights(i, 2), region.component[i] == region.component[n - 1]);
  }
}

TEST(GeodesicFalloff, BeginsAtTheVerticesOfTheLargestWeight) {
  Scene scene;
  const Points rest = scene.rest();
  scene.region.handle_weight.assign(scene.region.size(), 1);
  const int soft = scene.local({2494})[0];
  scene.region.handle_weight[soft] = 0.5;
  const Eigen::MatrixXd weights = geodesic_falloff(scene.region, rest).weights;
  EXPECT_EQ(weights(scene.local({2495})[0], 1), 1);
  EXPECT_LT(weights(soft, 1), 1);
}

/// Duplicated vertices, needles, and what is at no distance from a handle or an anchor.
TEST(GeodesicFalloff, IsFiniteOnDegenerateMeshes) {
  const TriangleMesh mesh = shapes::degenerate_grid(12, 12);
  const Region region = support::region_of(mesh, support::within(5), {{70}, {75}});
  const Eigen::MatrixXd weights = geodesic_falloff(region, support::rows(mesh.vertices, region.mesh_vertex)).weights;
  EXPECT_TRUE(weights.allFinite());
  EXPECT_GE(weights.minCoeff(), 0);
  EXPECT_LE(weights.rowwise().sum().maxCoeff(), 1 + 1e-15);
}

/// The rotations are those between the rest pose and the fallen-off one, estimated here again.
TEST(RoughDeformation, RotationsAreThoseOfTheFalloff) {
  const Scene scene;
  const Region& region = scene.region;
  EditSettings settings = EditSettings::of(EditMethod::Paper);
  settings.rough = RoughDeformation::Falloff;
  settings.normal_radius = 4;
  support::Prepared solver(scene.mesh, region, settings);
  const Points result = solver.pose(scene.maps);

  const Points rest = scene.rest();
  const Eigen::MatrixXd weights = geodesic_falloff(region, rest).weights;
  Points displacement(region.size(), 3);
  for (int i = 0; i < region.size(); ++i) {
    const Vector3 p = rest.row(i).transpose();
    displacement.row(i) =
        (weights(i, 0) * scene.maps[0].map.translation() + weights(i, 1) * (scene.maps[1].map * p - p)).transpose();
  }
  const SmoothingKernel kernel(region, rest, settings.normal_radius, 1);
  std::vector<Matrix3> expected;
  FrameRotations(region, kernel).estimate(rest, displacement, expected);
  EXPECT_LT(support::largest_angle(solver.rotations(), expected), 1e-9);

  settings.rough = RoughDeformation::Unrotated;
  EXPECT_GT(support::error(support::Prepared(scene.mesh, region, settings).pose(scene.maps), result), 1e-3);
}

}  // namespace
}  // namespace lapedit::geodesic_falloff_test
