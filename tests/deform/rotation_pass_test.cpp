// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/rotation_pass.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstdio>
#include <vector>

#include "lapedit/deform/edit_quality.h"
#include "lapedit/deform/membrane.h"
#include "lapedit/edit/laplacian_editor.h"
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
        const Matrix3 turn =
            settings.turning == DetailTurning::Edge ? Matrix3((rotations[i] + rotations[j]) / 2) : rotations[i];
        wanted.row(i) -= m(i, j) * (turn * (rest.row(i) - rest.row(j)).transpose()).transpose();
      }
    }
  }
  const Eigen::MatrixXd squared = w.cwiseAbs2().asDiagonal();
  const Eigen::MatrixXd stretch = (membrane_factor(settings, region, rest, op.sums.mean()) * op.sums).asDiagonal();
  const Eigen::MatrixXd left = m.transpose() + stretch;
  return (left * m + squared).ldlt().solve(left * wanted + squared * target);
}

TEST(RotationPass, TurnsWhatItSays) {
  const Scene scene;
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
    for (const DetailRotation rotation : {DetailRotation::SmoothSurface, DetailRotation::LocalGlobal}) {
      for (const double membrane : {0.0, 60.0}) {
        Points by_vertex;
        for (const DetailTurning turning : {DetailTurning::Vertex, DetailTurning::Edge}) {
          EditSettings settings = support::smooth_surface_settings();
          settings.laplacian = laplacian;
          settings.rotation = rotation;
          settings.membrane = membrane;
          settings.turning = turning;
          LaplacianEditor editor(scene.mesh, scene.region, settings);
          const Points result = editor.solve(scene.maps);
          EXPECT_LT(support::error(result, dense(scene, settings, editor.rotations())), 1e-9);
          if (turning == DetailTurning::Vertex) {
            by_vertex = result;
          } else {
            EXPECT_GT(support::error(result, by_vertex), 1e-3);
          }
        }
      }
    }
  }
}

/// With one rotation for all the two ways are one.
TEST(RotationPass, RigidMotionsOfAllConstraintsAreThatOfTheRegion) {
  const Scene scene;
  Affine turn = Affine::Identity();
  turn.rotate(Eigen::AngleAxisd(1.1, Vector3(1, 2, 3).normalized())).pretranslate(Vector3(3, -1, 2));
  for (const int order : {1, 2}) {
    EditSettings settings = support::smooth_surface_settings();
    settings.order = order;
    settings.turning = DetailTurning::Edge;
    LaplacianEditor editor(scene.mesh, scene.region, settings);
    Points expected(scene.region.size(), 3);
    for (int i = 0; i < scene.region.size(); ++i) {
      const Vector3 place = scene.mesh.vertices.row(scene.region.mesh_vertex[i]).transpose();
      expected.row(i) = (turn * place).transpose();
    }
    EXPECT_LT(support::error(editor.solve({turn}, turn), expected), 1e-9);
  }
}

/// A limb pulled by its tip: edges that turn on their own are stretched less than coordinates that turn as a whole.
TEST(RotationPass, EdgesOfALimbAreStretchedLessWhenTheyTurn) {
  const TriangleMesh mesh = shapes::tapered_arm(24, 80);
  const int tip = static_cast<int>(mesh.vertices.rows()) - 1;
  RegionSpec spec;
  spec.radius = 9;
  const Region region = build_region(mesh, support::adjacency_of(mesh), spec, {{tip}});
  double stretch[2] = {};
  for (const DetailTurning turning : {DetailTurning::Vertex, DetailTurning::Edge}) {
    EditSettings settings = support::smooth_surface_settings();
    settings.laplacian = LaplacianKind::Cotangent;
    settings.iterations = 3;
    settings.turning = turning;
    LaplacianEditor editor(mesh, region, settings);
    editor.solve({support::shift(Vector3(-3, 0, 6))});
    stretch[static_cast<int>(turning)] = editor.report().stretch_rms;
  }
  std::printf("RMS edge stretch of the limb: %.1f %% turned by vertices, %.1f %% by edges\n", 100 * stretch[0],
              100 * stretch[1]);
  EXPECT_LT(stretch[1], 0.85 * stretch[0]);
}

/// Bumps lifted by a line across them: with order 2 errors of the rotations grow from pass to pass.
struct Lift {
  TriangleMesh mesh = shapes::bumpy_grid();
  Region region;
  std::vector<HandleMotion> maps{support::shift(Vector3(0, 0, 40))};

  Lift() {
    RegionSpec spec;
    spec.radius = 42;
    std::vector<int> line;
    for (int j = 10; j < 50; ++j) {
      line.push_back(60 * 50 + j);
    }
    region = build_region(mesh, support::adjacency_of(mesh), spec, {line});
  }
  std::pair<Points, EditReport> solve(const EditSettings& settings) const {
    LaplacianEditor editor(mesh, region, settings);
    const Points result = editor.solve(maps);
    return {result, editor.report()};
  }
};

TEST(DroppedPass, LeavesThePassBefore) {
  const Lift lift;
  EditSettings settings = support::smooth_surface_settings();
  settings.laplacian = LaplacianKind::Cotangent;
  settings.order = 2;
  settings.iterations = 3;
  const auto [result, report] = lift.solve(settings);
  EXPECT_LT(report.iterations, 3);
  EXPECT_EQ(report.passes_dropped, 3 - report.iterations);
  EXPECT_NE(report.text().find("of 3 rotation passes, since they made it worse"), std::string::npos);
  EXPECT_LT(report.normal_equation_residual, 1e-13) << "of what was kept";

  EditSettings kept = settings;
  kept.iterations = report.iterations;
  kept.rotation = report.iterations > 0 ? kept.rotation : DetailRotation::None;
  const auto [before, alone] = lift.solve(kept);
  EXPECT_TRUE(support::same_bits(result, before));
  EXPECT_EQ(report.rotation_mean, alone.rotation_mean);
  EXPECT_EQ(alone.passes_dropped, 0);

  settings.order = kept.order = 3;
  settings.rough = RoughDeformation::Falloff;
  kept.rotation = DetailRotation::None;
  const auto [fallen, again] = lift.solve(settings);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_TRUE(support::same_bits(fallen, lift.solve(kept).first)) << "a fall-off alone is no result";
}

TEST(DroppedPass, IsNoneOfOrderOne) {
  const Lift lift;
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
    for (const DetailTurning turning : {DetailTurning::Vertex, DetailTurning::Edge}) {
      EditSettings settings = support::smooth_surface_settings();
      settings.laplacian = laplacian;
      settings.turning = turning;
      settings.iterations = 4;
      EXPECT_EQ(lift.solve(settings).second.passes_dropped, 0) << name(laplacian) << ", " << name(turning);
    }
  }
}

}  // namespace
}  // namespace lapedit
