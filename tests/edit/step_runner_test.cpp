// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_runner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/live/solver_thread.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

/// A step on a bumpy grid: four handle vertices, turned and moved.
struct Scene {
  TriangleMesh mesh = shapes::bumpy_grid();
  Adjacency adjacency = support::adjacency_of(mesh);
  EditStep step;

  Scene() {
    step.region.radius = 9;
    step.handles = {{{3030, 3031, 3090, 3091}, {}}};
    step.handles[0].transform.translation = Vector3(1, 2.0 / 3, 3);
    step.handles[0].transform.degrees = 40;
  }
  StepProblem problem(StoredScalar scalar) const {
    return {mesh, adjacency, step.region, {step.handles[0].vertices}, step.settings, scalar};
  }
  std::vector<HandleMotion> maps() const {
    const HandleGroup& handle = step.handles[0];
    return {resolve(handle.transform, centroid(mesh.vertices, handle.vertices))};
  }
};

/// Far from the origin single precision keeps no small displacement: that is said, and no weight helps.
TEST(StepRunner, AdviceNamesTheStepsOfCoordinatesFarFromTheOrigin) {
  Scene scene;
  scene.mesh.vertices.rowwise() += Eigen::RowVector3d(1e8, 0, 0);
  scene.step.handles[0].transform = {};
  scene.step.handles[0].transform.translation = Vector3(0.4, 0, 0);
  for (const StoredScalar scalar : {StoredScalar::Double, StoredScalar::Float}) {
    Points rounded = scene.mesh.vertices;
    round_to(scalar, rounded);
    scene.mesh.vertices = rounded;
    StepRunner runner(scene.problem(scalar));
    Points places;
    runner.solve(scene.maps(), places);
    const std::string advice = runner.report().advice();
    EXPECT_EQ(advice.find("mesh keeps coordinates in steps of 11.9: move the mesh to the origin") != std::string::npos,
              scalar == StoredScalar::Float)
        << advice;
  }
}

/// By the runner itself, as filters and programs run it, and as the window does.
TEST(StepRunner, EveryWayToRunAStepHasTheSameBits) {
  const Scene scene;
  for (const StoredScalar scalar : {StoredScalar::Float, StoredScalar::Double}) {
    StepRunner runner(scene.problem(scalar));
    Points places;
    runner.solve(scene.maps(), places);

    Edit edit;
    edit.steps = {scene.step};
    for (const EditResult& result :
         {apply_step(scene.mesh, scene.adjacency, scene.step, 1, scalar), apply_edit(scene.mesh, edit, 1, scalar)}) {
      EXPECT_EQ(result.vertices, runner.region().mesh_vertex);
      EXPECT_TRUE(support::same_bits(result.positions, places));
    }

    SolverThread thread(nullptr);
    SolverPose pose;
    thread.prepare({std::make_shared<const TriangleMesh>(scene.mesh),
                    std::make_shared<const Adjacency>(scene.adjacency),
                    scene.step.region,
                    {scene.step.handles[0].vertices},
                    scene.step.settings,
                    scalar});
    thread.solve(scene.maps(), true);
    while (thread.wait()) {
      thread.poll(pose);
    }
    EXPECT_TRUE(support::same_bits(pose.positions, places));
  }
}

TEST(StepRunner, RoundsToWhatTheMeshCanStore) {
  const Scene scene;
  Points in_double, in_float;
  StepRunner(scene.problem(StoredScalar::Double)).solve(scene.maps(), in_double);
  StepRunner(scene.problem(StoredScalar::Float)).solve(scene.maps(), in_float);
  EXPECT_FALSE(support::same_bits(in_double, in_float));
  EXPECT_TRUE(support::same_bits(in_double.cast<float>().cast<double>(), in_float));
}

/// Far from the origin the mesh's single precision is what a handle is off by.
TEST(StepRunner, ReportsHowFarOffIsWhatTheMeshStores) {
  Scene scene;
  scene.mesh.vertices.rowwise() += Vector3(1e6, -1e6, 1e6).transpose();
  for (const StoredScalar scalar : {StoredScalar::Float, StoredScalar::Double}) {
    StepRunner runner(scene.problem(scalar));
    Points places;
    runner.solve(scene.maps(), places);
    const Region& region = runner.region();
    double handle = 0, anchor = 0;
    for (int i = 0; i < region.size(); ++i) {
      const Vector3 place = places.row(i).transpose(),
                    rest = scene.mesh.vertices.row(region.mesh_vertex[i]).transpose();
      if (region.classes[i] == VertexClass::Handle) {
        handle = std::max(handle, (place - scene.maps()[0].map * rest).norm());
      } else if (region.classes[i] == VertexClass::Anchor) {
        anchor = std::max(anchor, (place - rest).norm());
      }
    }
    EXPECT_EQ(handle > 0.02, scalar == StoredScalar::Float) << "numbers there are 1/16 apart";
    EXPECT_NEAR(runner.report().handle_residual, handle, 1e-8);
    EXPECT_NEAR(runner.report().anchor_residual, anchor, 1e-8);
  }
}

TEST(StepRunner, TellsTheRegionBeforeItIsPrepared) {
  const Scene scene;
  std::vector<double> progress;
  std::size_t reports_before = 0;
  int told = 0;
  const StepRunner runner(
      scene.problem(StoredScalar::Float),
      [&](double done, const char*) {
        progress.push_back(done);
        return true;
      },
      [&](const Region& region) {
        told = region.size();
        reports_before = progress.size();
      });
  EXPECT_EQ(told, runner.region().size());
  EXPECT_EQ(reports_before, 1U);
  EXPECT_GT(progress.size(), reports_before);
  EXPECT_THROW(StepRunner(scene.problem(StoredScalar::Float), {},
                          [](const Region&) { throw EditError(ErrorCause::BadParameter, "no"); }),
               EditError);
}

TEST(StepRunner, GoesOnFromAnotherOne) {
  const Scene scene;
  auto first = std::make_unique<StepRunner>(scene.problem(StoredScalar::Double));
  Points before, after;
  first->solve(scene.maps(), before);
  EXPECT_FALSE(first->report().factor_taken_over);
  StepRunner second(scene.problem(StoredScalar::Double), {}, {}, std::move(first));
  second.solve(scene.maps(), after);
  EXPECT_TRUE(second.report().factor_taken_over);
  EXPECT_TRUE(support::same_bits(before, after));
}

/// The next drag in a region starts from the pose that the last one left. The umbrella does not see it; of the other
/// operators the matrix has other values in the same pattern.
TEST(StepRunner, NextDragInARegionTakesOverWhatIsTheSame) {
  struct Case {
    EditSettings settings;
    const char* taken;
  };
  EditSettings umbrella = support::smooth_surface_settings(), cotangent = umbrella, eigen;
  cotangent.laplacian = LaplacianKind::Cotangent;
  eigen.backend = CholeskyBackend::Eigen;
  for (const Case& c : {Case{umbrella, "operator and factor"}, Case{cotangent, "analysis"},
                        Case{EditSettings(), "analysis"}, Case{eigen, "ordering"}}) {
    Scene scene;
    scene.step.settings = c.settings;
    scene.step.region.kind = RegionSpec::Kind::Vertices;
    for (int v = 0; v < scene.mesh.vertices.rows(); ++v) {
      if ((scene.mesh.vertices.row(v) - scene.mesh.vertices.row(3030)).head<2>().norm() < 12) {
        scene.step.region.vertices.push_back(v);
      }
    }
    auto first = std::make_unique<StepRunner>(scene.problem(StoredScalar::Double));
    Points places, expected;
    first->solve(scene.maps(), places);
    EXPECT_EQ(first->taken_over(), "nothing");
    for (int i = 0; i < first->region().size(); ++i) {
      scene.mesh.vertices.row(first->region().mesh_vertex[i]) = places.row(i);
    }
    scene.step.region.anchors = anchors_of(first->region());
    StepRunner next(scene.problem(StoredScalar::Double), {}, {}, std::move(first));
    EXPECT_EQ(next.taken_over(), c.taken) << name(c.settings.laplacian);
    next.solve(scene.maps(), places);
    EXPECT_EQ(next.report().taken_over, c.taken);
    EXPECT_EQ(next.report().factor_taken_over, std::string(c.taken) == "operator and factor");
    StepRunner fresh(scene.problem(StoredScalar::Double));
    fresh.solve(scene.maps(), expected);
    EXPECT_TRUE(support::same_bits(places, expected)) << name(c.settings.laplacian);
  }
}

TEST(StepRunner, AnotherRegionTakesNothingOverAndTheThreadSaysSo) {
  const Scene scene;
  SolverThread thread(nullptr);
  PrepareTask task;
  task.mesh = std::make_shared<const TriangleMesh>(scene.mesh);
  task.adjacency = std::make_shared<const Adjacency>(scene.adjacency);
  task.region = scene.step.region;
  task.groups = {scene.step.handles[0].vertices};
  task.settings = scene.step.settings;
  SolverPose pose;
  std::vector<std::string> taken;
  const auto prepare = [&] {
    thread.prepare(task);
    while (thread.wait()) {
      const SolverNews news = thread.poll(pose);
      if (news.ready) {
        taken.push_back(news.taken_over);
      }
    }
  };
  prepare();
  prepare();
  task.region.radius = 12;
  prepare();
  EXPECT_EQ(taken, (std::vector<std::string>{"nothing", "operator and factor", "nothing"}));
}

}  // namespace
}  // namespace lapedit
