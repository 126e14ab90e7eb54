// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "allocation_watch.h"
#include "drag_support.h"
#include "shapes.h"
#include "support.h"
#include "torn_mesh.h"

namespace lapedit::drag_allocation_test {
namespace {

/// Drags a vertex, and expects no allocation once it has moved: from the mouse's move to the pose handed to the host,
/// by way of the worker's thread.
void expect_no_allocations(support::Window& window, int vertex) {
  window.press(vertex);
  const Vector2 from = window.at(vertex).pixel;
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

TEST(Drag, AllocatesNothingOnceItMoves) {
  support::Window window(shapes::letter_field(60, 30));
  window.change([](DragSettings& s) { s.handle_fraction = 0.1 / s.radius; });
  const int handle = support::vertex_at(window.session.mesh(), Vector3(2, 1, 0));
  window.click(handle);
  expect_no_allocations(window, handle);
}

TEST(Drag, BendingACurveAllocatesNothingOnceItMoves) {
  support::Window window(shapes::letter_field(60, 30));
  window.session.set(&Tools::mode, HandleMode::Curve);
  int end = 0;
  for (const double x : {1.8, 2.0, 2.2}) {
    end = support::vertex_at(window.session.mesh(), Vector3(x, 1, 0));
    window.click(end);
  }
  expect_no_allocations(window, end);
}

TEST(Drag, SeamAllocatesNothingOnceItMoves) {
  support::Window window(support::with_islands(shapes::grid(41, 41), 20));
  window.change([](DragSettings& s) { s.radius = 9; });
  const int handle = support::vertex_at(window.session.mesh(), Vector3(20, 20, 0));
  window.click(handle);
  expect_no_allocations(window, handle);
}

}  // namespace
}  // namespace lapedit::drag_allocation_test
