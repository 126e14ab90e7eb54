// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/snap.h"

#include <gtest/gtest.h>

#include "allocation_watch.h"
#include "drag_support.h"
#include "shapes.h"

namespace lapedit::snap_test {
namespace {

/// Seen from above: the sheet lies at z = 0, and a copy of it one unit lower.
class Snap : public ::testing::Test {
 protected:
  SnapTargets targets(const std::vector<double>& heights) const {
    std::vector<TriangleMesh> all(heights.size(), sheet);
    for (std::size_t k = 0; k < heights.size(); ++k) all[k].vertices.col(2).array() = heights[k];
    return SnapTargets(all);
  }

  const TriangleMesh sheet = shapes::grid(9, 9);
  const Vector3 middle = sheet.vertices.row(40).transpose();
  const Camera view = support::view_from(middle + Vector3(0, 0, 40), middle, Vector3::UnitY());
  const Vector2 pixel = view.pixel(middle);
};

TEST_F(Snap, TakesTheFirstSurfaceUnderTheCursor) {
  for (const auto& found : {targets({0, -1}).at(view, pixel), targets({-1, 0}).at(view, pixel)}) {
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->z(), 0, 1e-9);
    EXPECT_LT((view.pixel(*found) - pixel).norm(), 1e-6);
  }
  EXPECT_FALSE(targets({0}).at(view, Vector2(-1e5, 0)));
  EXPECT_FALSE(targets({}).at(view, pixel));
}

TEST_F(Snap, TargetsAreFoundWhenATranslationBegins) {
  int requests = 0;
  const auto above = std::make_shared<const SnapTargets>(targets({1}));
  DragSession session(sheet, StoredScalar::Float, {{}, {}, [&] {
                                                     ++requests;
                                                     return above;
                                                   }});
  const Cursor start{view, pixel}, end{view, pixel + Vector2(9, 7)};
  const auto drag = [&] {
    session.press(start);
    session.move(end);
    session.release(end);
    session.wait();
  };
  drag();
  EXPECT_EQ(requests, 0);
  session.undo();
  session.set(&Tools::snaps, true);
  session.press(start);
  session.release(start);
  session.wait();
  EXPECT_EQ(requests, 0) << "a click moves nothing";
  drag();
  EXPECT_EQ(requests, 1);
  EXPECT_NEAR(session.mesh().vertices(40, 2), 1, 0.1);
  session.undo();
  session.key(DragKey::Translate, start);
  EXPECT_EQ(requests, 2);
}

TEST_F(Snap, AllocatesNothing) {
  const SnapTargets two = targets({0, -1});
  two.at(view, pixel);
  const long before = allocations;
  for (int v = 0; v < 81; v += 9) two.at(view, view.pixel(sheet.vertices.row(v).transpose()));
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace lapedit::snap_test
