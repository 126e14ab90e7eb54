// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "drag_support.h"
#include "lapedit/mesh/vertex_tree.h"
#include "lapedit/mesh/weld.h"
#include "play.h"
#include "torn_mesh.h"

// Dragging on meshes with several vertices at the same place.
namespace lapedit::weld_session_test {
namespace {

using support::play;
using support::Window;

/// A grid of 60 x 60 vertices, and others at the places of a seam in its middle.
TriangleMesh torn_grid() {
  return support::with_islands(shapes::grid(60, 60), 30);
}

TEST(DragWeld, InvertedRegionReplays) {
  play("set radius 4; click 5,20; change invert; drag 30,20 20 40; steps 1; consistent", torn_grid());
}

TEST(DragWeld, SeamStaysClosed) {
  play(
      "set radius 9; click 30,20; press 30,20; move 30,20 40 60; wait; other pose rest; closed; release 30,20 40 60; "
      "wait; closed; consistent; set membrane 100; closed; drag 30,20 -20 10; steps 2; consistent; undo 2; same pose "
      "rest; redo 2; consistent; closed",
      torn_grid());
}

TEST(DragWeld, SelectionsOfOneSideCount) {
  support::Play played(torn_grid());
  Window& window = played.window;
  const Weld weld(window.session.original().vertices);
  std::vector<int> right;  // of the island beyond the seam, which has its other vertices
  for (int v = 0; v < static_cast<int>(window.session.original().vertices.rows()); ++v) {
    const auto faces = window.session.given_adjacency().faces[v];
    if (faces.size() > 0 && window.session.original().vertices(v, 0) >= 30 &&
        (weld.representative(v) != v || window.session.original().vertices(v, 0) > 30)) {
      right.push_back(v);
    }
  }
  window.session.set_painted(BrushTarget::Region, right);
  window.click(nearest_vertex(window.session.mesh(), Vector3(40, 20, 0)));
  EXPECT_TRUE(window.session.unconnected().empty());
  EXPECT_EQ(window.region().size(), right.size());
  window.drag(nearest_vertex(window.session.mesh(), Vector3(40, 20, 0)), Vector2(10, 30));
  played.run("closed; consistent");
}

}  // namespace
}  // namespace lapedit::weld_session_test
