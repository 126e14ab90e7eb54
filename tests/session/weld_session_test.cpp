// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "drag_support.h"
#include "lapedit/mesh/vertex_finder.h"
#include "lapedit/mesh/weld.h"
#include "torn_mesh.h"

// Dragging on meshes with several vertices at the same place.
namespace lapedit::weld_session_test {
namespace {

using support::same_bits;
using support::Window;

constexpr int kSide = 41;

TriangleMesh torn_plate() {
  return support::with_islands(shapes::grid(kSide, kSide), 20).mesh;
}

/// The vertex with faces nearest to a place on the seam.
int on_seam(Window& window, double y) {
  return nearest_vertex(window.session.mesh(), Vector3(20, y, 0));
}

int places_apart(const Points& now, const Points& before) {
  const Weld weld(before);
  int apart = 0;
  for (int v = 0; v < static_cast<int>(before.rows()); ++v) {
    apart += now.row(v) != now.row(weld.representative(v));
  }
  return apart;
}

TEST(DragWeld, InvertedRegionReplays) {
  Window window(torn_plate());
  window.change([](DragSettings& s) { s.radius = 4; });
  window.click(nearest_vertex(window.session.mesh(), Vector3(5, 20, 0)));
  window.session.change_painted(PaintChange::Invert);
  window.session.wait();
  window.drag(on_seam(window, 20), Vector2(20, 40));
  EXPECT_EQ(window.session.figures().steps, 1);
  window.expect_consistent();
}

TEST(DragWeld, SeamStaysClosed) {
  Window window(torn_plate());
  const Points before = window.host();
  ASSERT_FALSE(Weld(before).empty());
  window.change([](DragSettings& s) { s.radius = 9; });
  window.click(on_seam(window, 20));
  std::vector<int> all = window.region(), rows;
  Weld(before).add_others(all, rows);
  EXPECT_GT(all.size(), window.region().size());
  EXPECT_EQ(window.session.figures().fixed, static_cast<int>(before.rows()) - static_cast<int>(all.size()));
  window.press(on_seam(window, 20));
  window.session.move(window.at(on_seam(window, 20), Vector2(40, 60)));
  window.session.wait();
  EXPECT_GT((window.host() - before).rowwise().norm().maxCoeff(), 1);
  EXPECT_EQ(places_apart(window.host(), before), 0) << "a frame";
  window.session.release(window.at(on_seam(window, 20), Vector2(40, 60)));
  window.session.wait();
  EXPECT_EQ(places_apart(window.host(), before), 0) << "a step";
  window.expect_consistent();
  window.change([](DragSettings& s) { s.edit.membrane = 100; });
  EXPECT_EQ(places_apart(window.host(), before), 0) << "another setting";
  window.drag(on_seam(window, 20), Vector2(-20, 10));
  window.expect_consistent();
  window.undo(2);
  EXPECT_TRUE(same_bits(window.host(), before));
  window.redo(2);
  window.expect_consistent();
  EXPECT_EQ(places_apart(window.host(), before), 0);
}

TEST(DragWeld, SelectionsOfOneSideCount) {
  Window window(torn_plate());
  const Weld weld(window.session.original().vertices);
  std::vector<int> right;  // of the island beyond the seam, which has its other vertices
  for (int v = 0; v < static_cast<int>(window.session.original().vertices.rows()); ++v) {
    const auto faces = window.session.given_adjacency().faces[v];
    if (faces.size() > 0 && window.session.original().vertices(v, 0) >= 20 &&
        (weld.representative(v) != v || window.session.original().vertices(v, 0) > 20)) {
      right.push_back(v);
    }
  }
  window.session.set_region(right);
  window.click(nearest_vertex(window.session.mesh(), Vector3(30, 20, 0)));
  EXPECT_TRUE(window.session.unconnected().empty());
  EXPECT_EQ(window.region().size(), right.size());
  window.drag(nearest_vertex(window.session.mesh(), Vector3(30, 20, 0)), Vector2(10, 30));
  window.expect_consistent();
  EXPECT_EQ(places_apart(window.host(), window.session.original().vertices), 0);
}

}  // namespace
}  // namespace lapedit::weld_session_test
