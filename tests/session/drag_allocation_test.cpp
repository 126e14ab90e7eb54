// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <vector>

#include "allocation_watch.h"
#include "drag_support.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

/// What the interactive tool will do at each mouse move.
TEST(Drag, AllocatesNothingAfterTheFirstSolve) {
  const TriangleMesh mesh = shapes::letter_field(60, 30);
  RegionSpec region;
  region.radius = 0.9;
  const int handle = support::vertex_at(mesh, Vector3(2, 1, 0));
  for (const CholeskyBackend backend : {CholeskyBackend::Supernodal, CholeskyBackend::Eigen}) {
    for (const EditMethod method : {EditMethod::Linear, EditMethod::Paper, EditMethod::Default}) {
      const long before_all = allocations;
      support::Prepared solver(mesh, build_region(mesh, support::adjacency_of(mesh), region, {{handle}}),
                               EditSettings::of(method), {StoredScalar::Double, {}, {0, backend}});
      std::vector<HandleMotion> maps{support::shift(Vector3(0, 0, 0.4))};
      solver.pose(maps);
      ASSERT_GT(allocations.load(), before_all);  // or the count does not count
      const long before = allocations;
      for (int i = 0; i < 5; ++i) {
        maps[0].map.translation().x() += 0.01;
        solver.pose(maps);
      }
      EXPECT_EQ(allocations - before, 0) << name(method);
    }
  }
}

/// From the mouse's move to the pose handed to the host, by way of the worker's thread.
TEST(Drag, SessionAllocatesNothingOnceItMoves) {
  support::Window window(shapes::letter_field(60, 30));
  DragSettings settings = window.session.settings();
  settings.handle_fraction = 0.1 / settings.radius;
  window.session.set_settings(settings);
  const int handle = support::vertex_at(window.session.mesh(), Vector3(2, 1, 0));
  window.click(handle);
  window.press(handle);
  const Vector2 from = window.at(handle).pixel;
  const auto move = [&](int i) {
    const int poses = window.poses();
    window.session.move(window.at(from + Vector2(i, 2 * i)));
    while (window.poses() == poses) {
      window.session.poll();
    }
  };
  // Three buffers go round between worker, session and host: all have to have been used.
  for (int i = 1; i <= 6; ++i) {
    move(i);
  }
  window.session.wait();  // for the pose in full that follows where the mouse rests
  const int poses = window.poses();
  const long before = allocations;
  for (int i = 7; i <= 20; ++i) {
    move(i);
  }
  window.session.wait();
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GE(window.poses(), poses + 10);
}

TEST(Drag, BendingACurveAllocatesNothingOnceItMoves) {
  support::Window window(shapes::letter_field(60, 30));
  DragSettings settings = window.session.settings();
  window.session.set_settings(settings);
  window.session.set(&Tools::mode, HandleMode::Curve);
  for (const Vector3& position : {Vector3(1.8, 1, 0), Vector3(2.0, 1, 0), Vector3(2.2, 1, 0)}) {
    window.click(support::vertex_at(window.session.mesh(), position));
  }
  const int end = support::vertex_at(window.session.mesh(), Vector3(2.2, 1, 0));
  window.press(end);
  const Vector2 from = window.at(end).pixel;
  const auto move = [&](int i) {
    const int poses = window.poses();
    window.session.move(window.at(from + Vector2(i, 2 * i)));
    while (window.poses() == poses) {
      window.session.poll();
    }
  };
  for (int i = 1; i <= 6; ++i) {
    move(i);
  }
  window.session.wait();
  const long before = allocations;
  for (int i = 7; i <= 20; ++i) {
    move(i);
  }
  window.session.wait();
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace lapedit
