// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "allocation_watch.h"
#include "drag_support.h"
#include "shapes.h"
#include "support.h"
#include "torn_mesh.h"

namespace lapedit::drag_allocation_test {
namespace {

/// Drags a vertex that is clicked already, and expects no allocation once it has moved: from the mouse's move to the
/// pose handed to the host, by way of the worker's thread.
void expect_no_allocations(support::Window& window, int vertex) {
  window.press(vertex);
  const Vector2 from = window.at(vertex).pixel;
  int moves = 0;
  const auto move_to = [&](int last) {
    for (++moves; moves <= last; ++moves) {
      const int poses = window.poses();
      window.session.move(window.at(from + Vector2(moves, 2 * moves)));
      while (window.poses() == poses) window.session.poll();
    }
    window.session.wait();  // for the pose in full that follows where the mouse rests
  };
  move_to(6);  // three buffers go round between worker, session and host: all have to have been used
  const int poses = window.poses();
  const long before = allocations;
  move_to(20);
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GE(window.poses(), poses + 10);
}

TEST(Drag, AllocatesNothingOnceItMoves) {
  for (const HandleMode mode : {HandleMode::Vertex, HandleMode::Curve}) {
    support::Window window(shapes::letter_field(60, 30));
    window.change([](DragSettings& s) { s.handle_fraction = 0.1 / s.radius; });
    window.session.set(&Tools::mode, mode);
    int end = 0;
    for (const double x : {1.8, 2.0, 2.2}) {  // a curve, or the last one
      end = support::vertex_at(window.session.mesh(), Vector3(x, 1, 0));
      window.click(end);
    }
    expect_no_allocations(window, end);
  }
}

TEST(Drag, SeamAllocatesNothingOnceItMoves) {
  support::Window window(support::with_islands(shapes::grid(41, 41), 20));
  window.sizes(9);
  const int handle = support::vertex_at(window.session.mesh(), Vector3(20, 20, 0));
  window.click(handle);
  expect_no_allocations(window, handle);
}

}  // namespace
}  // namespace lapedit::drag_allocation_test
