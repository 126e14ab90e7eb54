// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/edit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "lapedit/base/error.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::edit_test {
namespace {

EditStep pull(std::vector<int> vertices, const Vector3& way, double radius = 8) {
  EditStep step;
  step.region.radius = radius;
  step.handles.resize(1);
  step.handles[0].vertices = std::move(vertices);
  step.handles[0].transform.translation = way;
  return step;
}

TEST(Edit, CentroidIsTheMeanOfVerticesOfTheMesh) {
  Points points(4, 3);
  points << 0, 0, 0, 2, 4, 6, 4, 2, 0, 100, 100, 100;
  EXPECT_EQ(centroid(points, {0, 1, 2}), Vector3(2, 2, 2));
  EXPECT_EQ(centroid(points, {1}), Vector3(2, 4, 6));
  points.array() += 1e15;  // far away a plain sum would lose the last digits
  EXPECT_EQ(centroid(points, {0, 1, 2}), Vector3::Constant(1e15 + 2));
  support::expect_refusal(ErrorCause::NoHandle, [&] { centroid(points, {}); });
  support::expect_refusal(ErrorCause::BadIndex, [&] { centroid(points, {0, 4}); });
  support::expect_refusal(ErrorCause::BadIndex, [&] { centroid(points, {-1, 0}); });
}

TEST(Edit, PosesAreGivenOneByOne) {
  const TriangleMesh mesh = shapes::grid(30, 20);
  const std::vector<double> fractions = {0.25, 1, 0, 0.5};
  Edit edit;
  edit.steps = {pull({310}, {0, 0, 3}), pull({313, 314}, {1, 0, 1}, 5), pull({310}, {0, 1, -1}, 6)};
  const auto count = static_cast<double>(fractions.size());
  double done = 0;
  std::size_t poses = 0;
  const auto each = [&](EditResult&& pose) {
    EXPECT_LE(done, static_cast<double>(++poses) / count + 1e-12);
    EXPECT_LT(pose.positions.rows(), mesh.vertices.rows()) << "a pose holds its region";
  };
  const auto progress = [&](double fraction, const char*) {
    EXPECT_GE(fraction, static_cast<double>(poses) / count - 1e-12);
    done = fraction;
    return true;
  };
  apply_edit(mesh, support::adjacency_of(mesh), edit, {}, fractions, each, StoredScalar::Double, progress);
  EXPECT_EQ(poses, fractions.size());
}

TEST(Edit, FractionOutsideZeroToOneIsRefused) {
  for (const double fraction : {-0.1, 1.25, std::nan("")}) {
    support::expect_refusal(ErrorCause::BadParameter, [&] {
      support::apply_step(shapes::grid(30, 20), pull({310}, {0, 0, 3}), fraction);
    });
  }
}

/// Counts the calls of an edit's stages on a grid of n x n, in one thread.
std::map<std::string, int> calls_of(EditStep step, int n, int* all = nullptr, int last = -1) {
  const TriangleMesh mesh = shapes::grid(n, n);
  step.region.kind = RegionSpec::Kind::Component;
  step.handles = pull({n * n / 2 + n / 2}, {0, 0, 3}).handles;
  step.handles.push_back(pull({0}, {0, 0, 0}).handles.front());  // or else all would move alike, without a solve
  Edit edit;
  edit.steps = {step};
  std::map<std::string, int> calls;
  int count = 0;
  apply_edit(mesh, edit, 1, StoredScalar::Double,
             [&](double, const char* stage) {
               ++calls[stage];
               if (all) {
                 *all = count + 1;
               }
               return ++count != last;
             },
             {1});
  return calls;
}

std::vector<EditStep> steps_of_all_kinds() {
  std::vector<EditStep> steps(5);
  steps[1].settings = EditSettings::of(EditMethod::Linear);
  steps[2].settings = EditSettings::of(EditMethod::Paper);
  steps[3].settings = EditSettings::of(EditMethod::Linear);
  steps[3].settings.order = 2;
  steps[4].region.connect_gap = 0.5;
  return steps;
}

/// The work between two calls has a limit that does not depend on the mesh, so calls grow with it. Fails if a stage
/// cannot be cancelled in between.
TEST(Edit, AsksAsOftenAsItsWorkGrows) {
  constexpr int kSmall = 100, kVertices = 8000;  // vertices per call, at most
  for (const EditStep& step : steps_of_all_kinds()) {
    if (step.settings.order > 1) {
      continue;  // too ill-conditioned on large grids
    }
    int few = 0, many = 0;
    calls_of(step, kSmall, &few);
    std::map<std::string, int> calls = calls_of(step, 2 * kSmall, &many);
    EXPECT_GE(many, 2 * few);
    for (const char* stage : {"mesh", "region", "operator", "factorisation", "solve"}) {
      EXPECT_GE(calls[stage], 4 * kSmall * kSmall / kVertices) << stage << " of " << name(step.settings.method);
    }
  }
}

TEST(Edit, EndsAtEachCallOfEachKind) {
  constexpr int kSize = 40;
  for (const EditStep& step : steps_of_all_kinds()) {
    int all = 0;
    calls_of(step, kSize, &all);
    ASSERT_GT(all, 20);
    for (int last = 1; last <= all; last += last < 20 ? 1 : 37) {
      int called = 0;
      support::expect_refusal(ErrorCause::Cancelled, [&] { calls_of(step, kSize, &called, last); });
      EXPECT_EQ(called, last);
    }
  }
}

}  // namespace
}  // namespace lapedit::edit_test
