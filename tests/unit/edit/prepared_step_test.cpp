// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/prepared_step.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lapedit/edit/edit.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::prepared_step_test {
namespace {

EditStep lifted(double height) {
  EditStep step;
  step.region.radius = 9;
  step.handles = {{{3030, 3031}, {}}};
  step.handles[0].transform.translation = Vector3(0, 0, height);
  return step;
}

/// Returns the whole mesh after an edit of one step.
Points edited(const TriangleMesh& mesh, const EditStep& step, double fraction) {
  return support::edited(mesh, support::apply_step(mesh, step, fraction));
}

Points posed(PreparedStep& step, const TriangleMesh& mesh, double fraction) {
  EditResult result;
  step.pose(fraction, result.vertices, result.positions);
  return support::edited(mesh, result);
}

/// Whatever was posed before.
TEST(PreparedStep, PosesAreEditsToTheBit) {
  const TriangleMesh mesh = shapes::bumpy_grid();
  for (const bool is_mirrored : {false, true}) {
    EditStep given = lifted(3);
    if (is_mirrored) {
      given.mirror = MirrorPlane{Vector3(44, 0, 0), Vector3(1, 0, 0)};
    }
    PreparedStep step(mesh, nullptr, given, {});
    EXPECT_EQ(step.system(), nullptr);
    step.prepare(support::adjacency_of(mesh), 1);
    for (const double fraction : {1.0, 0.3}) {
      EXPECT_EQ(posed(step, mesh, fraction), edited(mesh, given, fraction));
    }
    EditStep other = given;
    other.handles[0].transform.translation = Vector3(1, 0, -2);
    step.move(other);
    EXPECT_EQ(posed(step, mesh, 1), edited(mesh, other, 1));
    step.move(given);
    const Points last = posed(step, mesh, 1);
    EXPECT_EQ(last, edited(mesh, given, 1));
    EXPECT_GT(step.report(1, last).handle_displacement, 2.9);
  }
}

TEST(PreparedStep, OtherVerticesAreRefused) {
  const TriangleMesh mesh = shapes::bumpy_grid();
  PreparedStep step(mesh, nullptr, lifted(3), {});
  step.prepare(support::adjacency_of(mesh), 1);
  const Points before = posed(step, mesh, 1);
  EditStep other = lifted(2);
  other.handles[0].vertices.push_back(3032);
  for (const bool has_handles : {true, false}) {
    const std::string refusal = support::expect_refusal(ErrorCause::BadParameter, [&] { step.move(other); });
    EXPECT_EQ(refusal.find("handles[0]: these are not the vertices"), 0U) << refusal;
    other.handles.resize(has_handles ? 0 : 1);
  }
  EXPECT_EQ(posed(step, mesh, 1), before);
}

}  // namespace
}  // namespace lapedit::prepared_step_test
