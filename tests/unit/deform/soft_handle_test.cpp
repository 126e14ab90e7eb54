// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <memory>

#include "shapes.h"
#include "support.h"

namespace lapedit::soft_handle_test {
namespace {

/// A disc on a surface, with its vertices' distances from its centre.
struct Disc {
  TriangleMesh mesh;
  Adjacency adjacency = support::adjacency_of(mesh);
  int centre;
  double radius;
  std::vector<int> vertices;
  std::vector<double> distances;
  std::vector<double> from_centre;  // of all vertices

  Disc(TriangleMesh surface, const Vector3& middle, double r)
      : mesh(std::move(surface)), centre(support::vertex_at(mesh, middle)), radius(r) {
    from_centre = support::bellman_ford(mesh, {centre});
    for (int v = 0; v < static_cast<int>(from_centre.size()); ++v) {
      if (from_centre[v] <= radius) {
        vertices.push_back(v);
        distances.push_back(from_centre[v]);
      }
    }
  }

  Region soft(double reach) const {
    return build_region(mesh, adjacency, support::within(reach), {vertices}, 0, {falloff_weights(distances, radius)});
  }
};

Disc plane(double radius = 0.16, int columns = 160) {
  return {shapes::letter_field(columns, columns / 2, 0), {2, 1, 0}, radius};
}

TEST(SoftHandle, FallOffGoesSmoothlyFromOneToTheBoundary) {
  const std::vector<double> distances{0, 0.25, 0.5, 0.75, 0.9, 1};
  const std::vector<double> weights = falloff_weights(distances, 1);
  EXPECT_EQ(weights[0], 1);
  EXPECT_NEAR(weights[2], std::sqrt(0.3 / 6), 1e-15) << "half the exponent half way";
  EXPECT_NEAR(weights[5], 0.3 / 6, 1e-15) << "over the number of vertices";
  EXPECT_TRUE(std::is_sorted(weights.rbegin(), weights.rend()));
}

/// Large handles by the factor, small ones by a correction; weights down to nearly nothing.
TEST(SoftHandle, FramesFollowTheirWeights) {
  for (const double radius : {0.16, 0.04}) {
    const Disc disc = plane(radius);
    EXPECT_EQ(disc.vertices.size() <= 8, radius < 0.1);
    for (const double weight : {30.0, 1.0, 0.1, 0.003, 1e-6}) {
      for (const EditMethod method : {EditMethod::Linear, EditMethod::Default}) {
        EditSettings settings;
        settings.method = method;
        settings.handle_weight = weight;
        StepSolver solver(disc.mesh, {std::make_shared<const Region>(disc.soft(0.8))}, settings);
        const std::vector<HandleMotion> maps{support::rigid(30, {0, 1, 1}, {0, 0.1, 0.2}, {2, 1, 0})};
        Points cells, frame;
        solver.make_cells();
        solver.frame(maps, cells);
        solver.prepare(disc.mesh);
        const Points exact = solver.pose(maps);
        EXPECT_LT((cells - exact).rowwise().norm().maxCoeff(), 0.05) << weight << ", " << name(method);
        solver.frame(maps, frame);
        while (solver.refine(frame)) {
        }
        EXPECT_LT((frame - exact).rowwise().norm().maxCoeff(), 0.004) << weight << ", " << name(method);
      }
    }
  }
}

}  // namespace
}  // namespace lapedit::soft_handle_test
