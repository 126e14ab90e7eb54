// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/arap_peer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shapes.h"
#include "support.h"
#ifdef QUALITY_LIBIGL
#include "bench/igl_peer.h"
#endif

namespace quality {
namespace {

namespace shapes = lapedit::shapes;
namespace support = lapedit::support;

/// Largest distance of a handle or an anchor from where it has to be.
double control_error(const Scene& scene, const lapedit::Points& after) {
  double error = 0;
  for (int i = 0; i < scene.region.size(); ++i) {
    const int v = scene.region.mesh_vertex[i], group = scene.region.group[i];
    const lapedit::Vector3 rest = scene.edit.mesh.vertices.row(v);
    if (scene.region.classes[i] != lapedit::VertexClass::Free) {
      const lapedit::Vector3 target = group < 0 ? rest : scene.edit.maps[group] * rest;
      error = std::max(error, (lapedit::Vector3(after.row(v)) - target).norm());
    }
  }
  return error;
}

Scene lifted(const lapedit::TriangleMesh& mesh, int handle) {
  Edit edit;
  edit.mesh = mesh;
  edit.region.radius = 3.6;
  edit.handles = {{handle}};
  edit.maps = {support::shift({0, 0.2, 1})};
  return Scene(edit);
}

TEST(ArapPeer, HoldsHandleAndAnchorsAndTakesTheRestAlong) {
  const Scene scene = lifted(shapes::grid(12, 12), 12 * 6 + 6);
  std::vector methods = {arap, smooth_arap};
#ifdef QUALITY_LIBIGL
  methods.insert(methods.end(), {igl_arap, igl_biharmonic});
#endif
  for (const auto method : methods) {
    const MethodResult result = method(scene);
    EXPECT_LT(control_error(scene, result.positions), 1e-12);
    EXPECT_GT(result.positions(12 * 6 + 7, 2), 0.1);
    EXPECT_EQ(result.positions.row(0), scene.edit.mesh.vertices.row(0));
    const Figures figures = measure(scene, result);
    EXPECT_GT(figures.rms, 0.01);
    EXPECT_EQ(figures.flipped + figures.pairs, 0);
    EXPECT_LT(figures.behind, 1e-12);
  }
}

TEST(ArapPeer, AHandleThatStaysBehindIsMeasured) {
  const Scene scene = lifted(shapes::grid(12, 12), 12 * 6 + 6);
  MethodResult result = arap(scene);
  result.positions(12 * 6 + 6, 2) -= 0.1;
  EXPECT_NEAR(measure(scene, result).behind, 0.1 / std::hypot(0.2, 1), 1e-9);
}

TEST(ArapPeer, BadMeshesEndWithAResultOrARefusal) {
  for (const auto& mesh :
       {shapes::non_manifold_grid(12, 12), shapes::degenerate_grid(12, 12), shapes::inconsistent_grid(12, 12)}) {
    const Scene scene = lifted(mesh, 12 * 5 + 6);
    try {
      const MethodResult result = arap(scene);
      ASSERT_EQ(result.positions.rows(), mesh.vertices.rows());
      measure(scene, result);
    } catch (const std::runtime_error& refusal) {
      EXPECT_STREQ(refusal.what(), "CGAL could not factorise its matrix");
    }
  }
}

}  // namespace
}  // namespace quality
