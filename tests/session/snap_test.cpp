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
      all.push_back(sheet_);
      all.back().vertices.col(2).array() = height;
    }
    return all;
  }

  const TriangleMesh sheet_ = shapes::grid(9, 9);
  const Vector3 middle_ = sheet_.vertices.row(40).transpose();
  const Vector3 eye_ = middle_ + Vector3(0, 0, 40);
  const Camera view_ = support::view_from(eye_, middle_, Vector3::UnitY());
};

TEST_F(Snap, TakesTheFirstSurfaceUnderTheCursor) {
  const Vector2 pixel = view_.pixel(middle_);
  for (const auto& heights : {std::initializer_list<double>{0, -1}, {-1, 0}}) {
    const auto found = SnapTargets(sheets(heights)).at(view_, pixel);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->z(), 0, 1e-9);
    EXPECT_LT((view_.pixel(*found) - pixel).norm(), 1e-6);
  }
  EXPECT_FALSE(SnapTargets(sheets({0})).at(view_, Vector2(-1e5, 0)));
  EXPECT_FALSE(SnapTargets({}).at(view_, pixel));
}

TEST_F(Snap, TargetsAreFoundWhenATranslationBegins) {
  int requests = 0;
  const auto targets = std::make_shared<const SnapTargets>(sheets({1}));
  DragSession session(sheet_, StoredScalar::Float, {{}, {}, [&] {
                                                      ++requests;
                                                      return targets;
                                                    }});
  const Cursor start{view_, view_.pixel(middle_)}, end{view_, start.pixel + Vector2(9, 7)};
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
  targets.at(view_, view_.pixel(middle_));
  const long before = allocations;
  for (int k = 0; k < 9; ++k) {
    targets.at(view_, view_.pixel(sheet_.vertices.row(9 * k).transpose()));
  }
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace lapedit::snap_test
