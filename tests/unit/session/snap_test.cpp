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
  std::vector<TriangleMesh> sheets(std::initializer_list<double> heights) const {
    std::vector<TriangleMesh> all;
    for (const double height : heights) {
      all.push_back(sheet);
      all.back().vertices.col(2).array() = height;
    }
    return all;
  }

  const TriangleMesh sheet = shapes::grid(9, 9);
  const Vector3 middle = sheet.vertices.row(40).transpose();
  const Vector3 eye = middle + Vector3(0, 0, 40);
  const Camera view = support::view_from(eye, middle, Vector3::UnitY());
};

TEST_F(Snap, TakesTheFirstSurfaceUnderTheCursor) {
  const Vector2 pixel = view.pixel(middle);
  for (const auto& heights : {std::initializer_list<double>{0, -1}, {-1, 0}}) {
    const auto found = SnapTargets(sheets(heights)).at(view, pixel);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->z(), 0, 1e-9);
    EXPECT_LT((view.pixel(*found) - pixel).norm(), 1e-6);
  }
  EXPECT_FALSE(SnapTargets(sheets({0})).at(view, Vector2(-1e5, 0)));
  EXPECT_FALSE(SnapTargets({}).at(view, pixel));
}

TEST_F(Snap, TargetsAreFoundWhenATranslationBegins) {
  int requests = 0;
  auto targets = std::make_shared<const SnapTargets>(sheets({1}));
  DragSession session(sheet, StoredScalar::Float, {{}, {}, [&] {
                                                     ++requests;
                                                     return targets;
                                                   }});
  const Cursor start{view, view.pixel(middle)}, end{view, start.pixel + Vector2(9, 7)};
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
  const SnapTargets targets(sheets({0, -1}));
  targets.at(view, view.pixel(middle));
  const long before = allocations;
  for (int k = 0; k < 9; ++k) {
    targets.at(view, view.pixel(sheet.vertices.row(Eigen::Index{9} * k).transpose()));
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace lapedit::snap_test
