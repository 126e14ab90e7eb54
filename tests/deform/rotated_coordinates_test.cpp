// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/rotated_coordinates.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <vector>

#include "lapedit/deform/membrane.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

/// A region of a bumpy grid with one handle.
struct Scene {
  TriangleMesh mesh = shapes::bumpy_grid();
  Region region;
  std::vector<HandleMotion> maps{support::shift(Vector3(2, 1, 6))};

  explicit Scene(double radius = 7) {
    RegionSpec spec;
    spec.radius = radius;
    region = build_region(mesh, support::adjacency_of(mesh), spec, {{3030}});
  }
};

/// The paper's system and its membrane by dense algebra, with the rotations that the editor says it took.
Points dense(const Scene& scene, const EditSettings& settings, const std::vector<Matrix3>& rotations) {
  const Region& region = scene.region;
  const int n = region.size();
  const DifferentialOperator op = differential_operator(settings.laplacian, region, scene.mesh, settings.membrane > 0);
  const Eigen::MatrixXd m = op.matrix;
  Points rest(n, 3), wanted = Points::Zero(n, 3);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) {
    rest.row(i) = scene.mesh.vertices.row(region.mesh_vertex[i]);
    if (region.classes[i] == VertexClass::Handle) {
      w[i] = settings.handle_weight;
    } else if (region.classes[i] == VertexClass::Anchor) {
      w[i] = settings.anchor_weight * region.anchor_weight[i];
    }
  }
  Points target = rest;
  for (int i = 0; i < n; ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      target.row(i) = (scene.maps[0].map * Vector3(rest.row(i).transpose())).transpose();
    }
    for (int j = 0; j < n; ++j) {
      if (j != i) {
        const Matrix3 rotation =
            settings.method == EditMethod::Default ? Matrix3((rotations[i] + rotations[j]) / 2) : rotations[i];
        wanted.row(i) -= m(i, j) * (rotation * (rest.row(i) - rest.row(j)).transpose()).transpose();
      }
    }
  }
  const Eigen::MatrixXd squared = w.cwiseAbs2().asDiagonal();
  const Eigen::MatrixXd stretch = (membrane_factor(settings, region, rest, op.sums.mean()) * op.sums).asDiagonal();
  const Eigen::MatrixXd left = m.transpose() + stretch;
  return (left * m + squared).ldlt().solve(left * wanted + squared * target);
}

TEST(RotatedCoordinates, AreThoseOfTheMethod) {
  const Scene scene;
  for (const EditMethod method : {EditMethod::Default, EditMethod::Paper}) {
    for (const LaplacianKind laplacian :
         {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
      for (const double membrane : {0.0, 60.0}) {
        EditSettings settings = EditSettings::of(method);
        settings.laplacian = laplacian;
        settings.membrane = membrane;
        support::Prepared solver(scene.mesh, scene.region, settings);
        const Points result = solver.pose(scene.maps);
        EXPECT_LT(support::error(result, dense(scene, settings, solver.rotations())), 1e-9) << name(method);
      }
    }
  }
}

/// With one rotation for all vertices, edges and whole coordinates rotate alike.
TEST(RotatedCoordinates, RigidMotionsOfAllConstraintsAreThatOfTheRegion) {
  const Scene scene;
  Affine map = Affine::Identity();
  map.rotate(Eigen::AngleAxisd(1.1, Vector3(1, 2, 3).normalized())).pretranslate(Vector3(3, -1, 2));
  for (const EditMethod method : {EditMethod::Default, EditMethod::Paper}) {
    for (int order = 1; order <= (method == EditMethod::Paper ? 2 : 1); ++order) {
      EditSettings settings = EditSettings::of(method);
      settings.order = order;
      support::Prepared solver(scene.mesh, scene.region, settings);
      const Points expected = support::moved(map, support::rows(scene.mesh.vertices, scene.region.mesh_vertex));
      EXPECT_LT(support::error(solver.pose({map}, map), expected), 1e-9) << name(method) << ", order " << order;
    }
  }
}

}  // namespace
}  // namespace lapedit
