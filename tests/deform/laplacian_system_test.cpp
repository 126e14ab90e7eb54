// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/laplacian_system.h"

#include <gtest/gtest.h>

#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

using System = std::shared_ptr<const LaplacianSystem>;

/// A field of letters whose handle moves on while region and anchors stay.
struct Scene {
  TriangleMesh mesh = shapes::letter_field(60, 40);
  Region first, second;

  Scene() {
    first = support::whole_region(mesh, {{1200}}, rim());
    second = support::whole_region(mesh, {{1321}}, rim());
    second.max_distance = first.max_distance;  // as where anchors are kept
  }
  std::vector<int> rim() const {
    std::vector<int> vertices;
    for (int v = 0; v < 2400; ++v) {
      if (v < 80 || v >= 2320) {
        vertices.push_back(v);
      }
    }
    return vertices;
  }
};

System prepared(const TriangleMesh& mesh, const Region& region, const EditSettings& settings,
                const LaplacianSystem* previous, EditReport& report) {
  return prepare_system(mesh, support::rest_pose(mesh, region), settings, previous, {}, report);
}

Points solved(const System& system) {
  RefinedSolver solver(system->matrix, system->correction, std::make_shared<ThreadPool>(1));
  Points right = Points::Zero(system->region.size(), 3), x;
  right.row(1200).setConstant(100);
  right.row(5).setConstant(-1);
  solver.refine_to_the_bit(right, x);
  return x;
}

TEST(LaplacianSystem, NextHandleSharesOperatorFactorAndSmootherByPointer) {
  const Scene scene;
  for (const EditSettings& settings : {EditSettings(), support::smooth_surface_settings()}) {
    EditReport report;
    const System first = prepared(scene.mesh, scene.first, settings, nullptr, report);
    EXPECT_FALSE(report.factor_taken_over);
    const System second = prepared(scene.mesh, scene.second, settings, first.get(), report);
    EXPECT_TRUE(report.factor_taken_over);
    EXPECT_EQ(second->powers.m, first->powers.m);
    EXPECT_EQ(second->powers.first, second->powers.m) << "of order 1";
    EXPECT_EQ(second->matrix, first->matrix);
    EXPECT_EQ(second->smoother, first->smoother);
    EXPECT_EQ(first->smoother == nullptr, settings.rotation == DetailRotation::LocalGlobal);
    EXPECT_NE(second->correction, first->correction) << "that of another handle";
  }
}

/// Fails if the next system takes something out of the one before, or what it shares is not what it would make.
TEST(LaplacianSystem, BothStayUsableWithTheSameBits) {
  const Scene scene;
  for (const EditSettings& settings : {EditSettings(), support::smooth_surface_settings()}) {
    EditReport report;
    const System first = prepared(scene.mesh, scene.first, settings, nullptr, report);
    const Points before = solved(first);
    const System second = prepared(scene.mesh, scene.second, settings, first.get(), report);
    const System alone = prepared(scene.mesh, scene.second, settings, nullptr, report);
    EXPECT_TRUE(support::same_bits(solved(first), before));
    EXPECT_TRUE(support::same_bits(solved(second), solved(alone)));
    EXPECT_FALSE(support::same_bits(solved(second), before)) << "another handle, another result";
    if (settings.rotation == DetailRotation::LocalGlobal) {
      continue;
    }
    Points smooth, smooth_before;
    first->smoother->share(nullptr)->apply(first->rest.local, smooth_before);
    second->smoother->share(nullptr)->apply(first->rest.local, smooth);
    EXPECT_TRUE(support::same_bits(smooth, smooth_before));
  }
}

/// Each part goes by what it is made from.
TEST(LaplacianSystem, OnlyWhatFitsIsShared) {
  const Scene scene;
  EditReport report;
  const System first = prepared(scene.mesh, scene.first, support::smooth_surface_settings(), nullptr, report);
  const auto next = [&](auto change) {
    EditSettings settings = support::smooth_surface_settings();
    change(settings);
    return prepared(scene.mesh, scene.second, settings, first.get(), report);
  };
  const System heavier = next([](EditSettings& s) { s.anchor_weight = 20; });
  EXPECT_EQ(heavier->powers.m, first->powers.m);
  EXPECT_NE(heavier->matrix, first->matrix);
  EXPECT_EQ(heavier->smoother, first->smoother);
  const System wider = next([](EditSettings& s) { s.normal_radius = 0.7; });
  EXPECT_EQ(wider->matrix, first->matrix);
  EXPECT_NE(wider->smoother, first->smoother);
  const System cotangent = next([](EditSettings& s) { s.laplacian = LaplacianKind::Cotangent; });
  EXPECT_NE(cotangent->powers.m, first->powers.m);
  EXPECT_NE(cotangent->matrix, first->matrix);
  EXPECT_EQ(cotangent->smoother, first->smoother);
  const System higher = next([](EditSettings& s) { s.order = 2; });
  EXPECT_NE(higher->powers.m, higher->powers.first);
  EXPECT_NE(higher->matrix, first->matrix);
  const System stretched = next([](EditSettings& s) { s.membrane = 100; });
  EXPECT_NE(stretched->powers.m, first->powers.m);
  EXPECT_NE(stretched->matrix, first->matrix);
  EXPECT_EQ(stretched->smoother, first->smoother);
  const System plain = next([](EditSettings& s) { s.rotation = DetailRotation::None; });
  EXPECT_EQ(plain->smoother, nullptr);
  EXPECT_EQ(plain->matrix, first->matrix);
}

}  // namespace
}  // namespace lapedit
