// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "lapedit/base/error.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::step_test {
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
  std::unique_ptr<StepSolver> solver(StoredScalar scalar) const {
    auto made = std::make_unique<StepSolver>(mesh, find_region(mesh, adjacency, step.region, groups_of(step)),
                                             step.settings, StepOptions{scalar});
    made->prepare(mesh);
    return made;
  }
  std::vector<HandleMotion> maps() const {
    const HandleGroup& handle = step.handles[0];
    return {resolve(handle.transform, centroid(mesh.vertices, handle.vertices))};
  }
};

/// Far from the origin single precision keeps no small displacement: that is said, and no weight helps.
TEST(Step, AdviceNamesTheStepsOfCoordinatesFarFromTheOrigin) {
  Scene scene;
  scene.mesh.vertices.rowwise() += Eigen::RowVector3d(1e8, 0, 0);
  scene.step.handles[0].transform = {};
  scene.step.handles[0].transform.translation = Vector3(0.4, 0, 0);
  for (const StoredScalar scalar : {StoredScalar::Double, StoredScalar::Float}) {
    Points rounded = scene.mesh.vertices;
    round_to(scalar, rounded);
    scene.mesh.vertices = rounded;
    const auto solver = scene.solver(scalar);
    const Points positions = solver->pose(scene.maps());
    const std::string advice = solver->report().advice();
    for (const char* sentence : {"mesh keeps coordinates in steps of 11.9: move the mesh to the origin",
                                 "mesh stores coordinates there in steps of 11.9: move the mesh near the origin"}) {
      EXPECT_EQ(advice.find(sentence) != std::string::npos, scalar == StoredScalar::Float) << advice;
    }
  }
}

/// Far from the origin the mesh's single precision is what a handle is off by.
TEST(Step, ReportsHowFarOffIsWhatTheMeshStores) {
  Scene scene;
  scene.mesh.vertices.rowwise() += Vector3(1e6, -1e6, 1e6).transpose();
  for (const StoredScalar scalar : {StoredScalar::Float, StoredScalar::Double}) {
    const auto solver = scene.solver(scalar);
    const Points positions = solver->pose(scene.maps());
    const Region& region = solver->region();
    double handle = 0, anchor = 0;
    for (int i = 0; i < region.size(); ++i) {
      const Vector3 position = positions.row(i).transpose(),
                    rest = scene.mesh.vertices.row(region.mesh_vertex[i]).transpose();
      if (region.classes[i] == VertexClass::Handle) {
        handle = std::max(handle, (position - scene.maps()[0].map * rest).norm());
      } else if (region.classes[i] == VertexClass::Anchor) {
        anchor = std::max(anchor, (position - rest).norm());
      }
    }
    EXPECT_EQ(handle > 0.02, scalar == StoredScalar::Float) << "numbers there are 1/16 apart";
    EXPECT_NEAR(solver->report().handle_residual, handle, 1e-8);
    EXPECT_NEAR(solver->report().anchor_residual, anchor, 1e-8);
  }
}

}  // namespace
}  // namespace lapedit::step_test
