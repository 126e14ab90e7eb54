// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_motion.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "allocation_watch.h"
#include "drag_support.h"
#include "lapedit/session/drag_key.h"
#include "lapedit/session/snap.h"

namespace lapedit::drag_motion_test {
namespace {

const Vector3 kCenter(1, 2, 3);

Cursor over(const Camera& view, const Vector3& point, const Vector2& off = Vector2::Zero()) {
  return {view, view.pixel(point) + off};
}

/// Aslant, and along z.
const Camera kOblique = support::view_from(Vector3(8, -6, 9), kCenter);
const Camera kAlongZ = support::view_from(kCenter + Vector3(0, 0, 9), kCenter, Vector3::UnitY());

/// About kCenter, which is grabbed.
DragMotion motion(MotionKind kind, const Cursor& cursor, const Vector3& normal = Vector3::UnitZ(),
                  const std::optional<Vector3>& pivot = {}, double radius = 0) {
  return {kind, kCenter, kCenter, normal, cursor, pivot, radius};
}

void type(DragMotion& m, const std::string& text) {
  for (const char c : text) EXPECT_TRUE(m.type(c)) << text;
}

TEST(DragMotion, TranslationKeepsTheGrabbedPointUnderTheCursor) {
  const Camera& view = kOblique;
  for (const Vector2& off : {Vector2(0, 0), Vector2(3, -2)}) {
    const Vector3 grab = view.beside(kCenter, over(view, kCenter, off).pixel);
    DragMotion m(MotionKind::Translate, grab, kCenter, Vector3::UnitZ(), over(view, grab));
    EXPECT_FALSE(m.moves());
    m.move(over(view, grab, Vector2(50, 70)));
    EXPECT_TRUE(m.moves());
    const Vector3 now = grab + m.transform().translation;
    EXPECT_LT((view.pixel(now) - over(view, grab, Vector2(50, 70)).pixel).norm(), 1e-6);
    EXPECT_NEAR(m.transform().translation.dot(Vector3(7, -8, 6).normalized()), 0, 1e-9) << "along the line of sight";
    m.move(over(view, grab));
    EXPECT_LT(m.transform().translation.norm(), 1e-9);
  }
}

TEST(DragMotion, LockedAxisTakesTheNearestPointToTheCursor) {
  const Camera& view = kOblique;
  DragMotion m = motion(MotionKind::Translate, over(view, kCenter));
  ASSERT_TRUE(m.toggle_lock(AxisLock::Y));
  m.move(over(view, kCenter + Vector3(0, 1.25, 0)));
  EXPECT_LT((m.transform().translation - Vector3(0, 1.25, 0)).norm(), 1e-9);
  m.toggle_lock(AxisLock::Y);
  EXPECT_EQ(m.lock(), AxisLock::None);
  ASSERT_TRUE(m.toggle_lock(AxisLock::Z));
  EXPECT_EQ(m.transform().translation.x(), 0);
  EXPECT_EQ(m.transform().translation.y(), 0);
}

TEST(DragMotion, AxisAlongTheSightDoesNotRunAway) {
  const Camera& view = kAlongZ;
  DragMotion m = motion(MotionKind::Translate, over(view, kCenter));
  m.toggle_lock(AxisLock::Z);
  m.move(over(view, kCenter, Vector2(2, 0)));
  EXPECT_LT(m.transform().translation.norm(), 9);
}

TEST(DragMotion, NormalLockNeedsANormal) {
  EXPECT_FALSE(motion(MotionKind::Translate, over(kOblique, kCenter), Vector3::Zero()).toggle_lock(AxisLock::Normal));
}

TEST(DragMotion, RotationFollowsTheCursorAboutTheCenter) {
  const Camera& view = kAlongZ;
  // Seen from +z, counter-clockwise on the screen is counter-clockwise about z.
  DragMotion m = motion(MotionKind::Rotate, over(view, kCenter, Vector2(100, 0)));
  EXPECT_LT((m.arm() - Vector3::UnitX()).norm(), 1e-9);
  m.move(over(view, kCenter, Vector2(0, -100)));
  EXPECT_NEAR(m.transform().degrees, 90, 1e-9);
  EXPECT_LT((m.transform().axis - Vector3::UnitZ()).norm(), 1e-9);
  m.move(over(view, kCenter, Vector2(-100, 0)));
  m.move(over(view, kCenter, Vector2(0, 100)));
  m.move(over(view, kCenter, Vector2(100, 1)));
  EXPECT_NEAR(m.transform().degrees, 360, 1);  // revolutions add up
  EXPECT_LT((m.arm() - Vector3::UnitX()).norm(), 1e-9);
  EXPECT_EQ(m.transform().translation, Vector3::Zero());
}

TEST(DragMotion, RotationAboutALockedAxisIsThatOfTheSurfaceOnTheScreen) {
  for (const double side : {1.0, -1.0}) {
    const Camera view = support::view_from(kCenter + Vector3(0, 0.1, side * 9), kCenter, Vector3::UnitY());
    DragMotion m = motion(MotionKind::Rotate, over(view, kCenter, Vector2(100, 0)));
    m.toggle_lock(AxisLock::Z);
    m.move(over(view, kCenter, Vector2(0, -100)));
    EXPECT_NEAR(m.transform().degrees, side * 90, 1e-6);
    EXPECT_EQ(m.transform().axis, Vector3::UnitZ());
    // A point to the right on the screen goes up.
    const Vector3 right = view.beside(kCenter, over(view, kCenter, Vector2(100, 0)).pixel);
    const Vector3 turned = resolve(m.transform(), kCenter).map * right;
    EXPECT_LT(view.pixel(turned).y(), view.pixel(kCenter).y() - 90);
  }
}

TEST(DragMotion, ScaleIsTheGrowthOfTheDistanceFromTheCenter) {
  const Camera& view = kOblique;
  DragMotion m = motion(MotionKind::Scale, over(view, kCenter, Vector2(100, 0)));
  m.move(over(view, kCenter, Vector2(0, 150)));
  EXPECT_NEAR(m.transform().scale, 1.5, 1e-9);
  m.move(over(view, kCenter));
  EXPECT_GT(m.transform().scale, 0);
}

TEST(DragMotion, ScaleWithALockIsAlongItsAxisAlone) {
  const Camera& view = kOblique;
  const Vector3 pivot(0, 4, 1);
  DragMotion m = motion(MotionKind::Scale, over(view, kCenter), Vector3::UnitZ(), pivot);
  m.toggle_lock(AxisLock::Y);
  EXPECT_FALSE(m.moves());
  type(m, "105%");
  const Affine map = resolve(m.transform(), kCenter).map;
  EXPECT_LT((map * pivot - pivot).norm(), 1e-12);
  EXPECT_LT((map * Vector3(2, 3, 5) - Vector3(2, 4 - 1.05, 5)).norm(), 1e-12);
  EXPECT_TRUE(m.moves());
  EXPECT_EQ(m.text(), "Scaling by 1.05 along Y (typed 105%)");
  m.toggle_lock(AxisLock::Y);
  EXPECT_FALSE(m.transform().matrix);
  EXPECT_EQ(m.transform().scale, 1.05);
}

TEST(DragMotion, TypedPercentagesAreOfTheRadiusAndOfARevolution) {
  const Camera& view = kOblique;
  for (const MotionKind kind : {MotionKind::Translate, MotionKind::Rotate}) {
    DragMotion m = motion(kind, over(view, kCenter), Vector3::UnitZ(), {}, 8);
    EXPECT_FALSE(m.type('%')) << "without a number";
    type(m, "25%");
    EXPECT_FALSE(m.type('%'));
    EXPECT_FALSE(m.type('5'));
    const bool translates = kind == MotionKind::Translate;
    EXPECT_EQ(translates ? m.transform().translation.z() : m.transform().degrees, translates ? 2 : 90);
  }
}

TEST(DragMotion, TypedAmountReplacesTheMouse) {
  const Camera& view = kOblique;
  DragMotion m = motion(MotionKind::Translate, over(view, kCenter), Vector3(0, 0, 5));
  type(m, "0.75");
  EXPECT_FALSE(m.type('.'));
  EXPECT_FALSE(m.type('a'));
  EXPECT_EQ(m.transform().translation, Vector3(0, 0, 0.75));  // not moved yet: along the normal
  m.type('-');
  m.toggle_lock(AxisLock::X);
  EXPECT_EQ(m.transform().translation, Vector3(-0.75, 0, 0));
  EXPECT_FALSE(std::signbit(m.transform().translation.y()));  // JSON would lose a negative zero
  m.move(over(view, kCenter, Vector2(200, 0)));
  EXPECT_EQ(m.transform().translation, Vector3(-0.75, 0, 0));
  EXPECT_EQ(m.text(), "Moving by -0.75 along X (typed -0.75)");
}

TEST(DragMotion, GoesOnUnderAnotherView) {
  const Camera& view = kOblique;
  const Camera other = support::view_from(Vector3(-5, 8, 7), kCenter);
  DragMotion m = motion(MotionKind::Translate, over(view, kCenter));
  m.move(over(view, kCenter, Vector2(40, 0)));
  const Vector3 before = m.transform().translation;
  m.move(over(other, kCenter, Vector2(-30, 10)));
  EXPECT_LT((m.transform().translation - before).norm(), 1e-9);
  m.move(over(other, kCenter, Vector2(-10, 10)));
  const Vector3 held = kCenter + before;
  EXPECT_LT((other.pixel(kCenter + m.transform().translation) - other.pixel(held) - Vector2(20, 0)).norm(), 1e-6);
}

TEST(DragMotion, AnotherPivotIsNamedInTheTransform) {
  const Camera& view = kOblique;
  const Vector3 pivot(2, 1, 2.5), point(0, 1, 4);
  for (const MotionKind kind : {MotionKind::Rotate, MotionKind::Scale}) {
    DragMotion m = motion(kind, over(view, pivot, Vector2(100, 0)), Vector3::UnitZ(), pivot);
    m.move(over(view, pivot, Vector2(30, 120)));
    EXPECT_TRUE(m.moves());
    const Affine map = resolve(m.transform(), kCenter).map;
    EXPECT_LT((map * pivot - pivot).norm(), 1e-12);
    EXPECT_GT((map * point - point).norm(), 0.1);
    EXPECT_FALSE(motion(kind, over(view, kCenter)).transform().center);
  }
  // It means nothing.
  EXPECT_FALSE(motion(MotionKind::Translate, over(view, kCenter), Vector3::UnitZ(), pivot).transform().center);
}

TEST(DragMotion, SnapsLengthsToRoundStepsOfAFewPixels) {
  for (const double zoom : {1e-3, 0.02, 1.0, 7.0, 300.0}) {
    const Camera view = support::view_from(kCenter + zoom * Vector3(8, -6, 9), kCenter);
    for (const bool along_y : {false, true}) {
      DragMotion m = motion(MotionKind::Translate, over(view, kCenter));
      if (along_y) m.toggle_lock(AxisLock::Y);
      EXPECT_EQ(m.step(), 0);
      Cursor cursor = over(view, kCenter, Vector2(93, 41));
      cursor.snap = true;
      m.move(cursor);
      const double step = m.step();
      const double pixels = step / view.pixel_size(kCenter);
      EXPECT_GE(pixels, 10);
      EXPECT_LE(pixels, 25.0001);
      const double digit = step / std::pow(10, std::floor(std::log10(step * 1.0001)));
      EXPECT_LT(std::min({std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)}), 1e-9);
      const double steps = m.transform().translation.norm() / step;
      EXPECT_GE(steps, 1);
      EXPECT_NEAR(steps, std::round(steps), 1e-9);
      cursor.snap = false;
      m.move(cursor);
      const double free = m.transform().translation.norm() / step;
      EXPECT_GT(std::abs(free - std::round(free)), 1e-6);
    }
  }
}

TEST(DragMotion, SnapsAnglesAndFactors) {
  const auto snapped = [](DragMotion& m, const Vector2& off) {
    Cursor cursor = over(kAlongZ, kCenter, off);
    cursor.snap = true;
    m.move(cursor);
    return m.transform();
  };
  DragMotion rotation = motion(MotionKind::Rotate, over(kAlongZ, kCenter, Vector2(100, 0)));
  EXPECT_EQ(snapped(rotation, Vector2(50, -90)).degrees, 60);
  EXPECT_EQ(rotation.text(), "Turning by 60 degrees (in steps of 15)");
  rotation.type('7');
  EXPECT_EQ(rotation.transform().degrees, 7);
  EXPECT_EQ(rotation.text(), "Turning by 7 degrees (typed 7)");
  DragMotion scale = motion(MotionKind::Scale, over(kAlongZ, kCenter, Vector2(100, 0)));
  EXPECT_EQ(snapped(scale, Vector2(0, 132)).scale, 1.3);
  EXPECT_EQ(scale.text(), "Scaling by 1.3 (in steps of 0.1)");
  EXPECT_EQ(snapped(scale, Vector2(0, 1)).scale, 0.1);
}

TEST(DragMotion, SnappedAmountsGoOnFreelyUnderAnotherView) {
  const Camera& view = kOblique;
  DragMotion free = motion(MotionKind::Translate, over(view, kCenter)), snapped = free;
  Cursor cursor = over(view, kCenter, Vector2(47, 8));
  free.move(cursor);
  cursor.snap = true;
  snapped.move(cursor);
  const Cursor other = over(support::view_from(Vector3(-5, 8, 7), kCenter), kCenter, Vector2(-30, 10));
  free.move(other);
  snapped.move(other);
  EXPECT_EQ(free.transform().translation, snapped.transform().translation);
}

TEST(DragMotion, TheAxisOfAGizmoIsFoundByItsName) {
  const Camera& view = kOblique;
  DragMotion m = motion(MotionKind::Translate, over(view, kCenter));
  m.hold(Vector3(0, 3, 0));
  EXPECT_EQ(m.lock(), AxisLock::Gizmo);
  EXPECT_EQ(*m.axis(), Vector3::UnitY());
  m.type('2');
  EXPECT_EQ(m.text(), "Moving by 2 along Y (typed 2)");
  EXPECT_EQ(m.transform().translation, Vector3(0, 2, 0));
  m.hold(Vector3(1, 1, 0));
  EXPECT_EQ(m.text(), "Moving by 2 along the gizmo's axis (typed 2)");
}

/// Some mesh files have a coordinate near the largest float, or an infinite one, in the middle of others.
TEST(DragMotion, NoViewOfFarPlacesMakesATransformThatIsNoNumber) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-30, 38.5), unit(-1, 1);
  const auto far = [&] { return std::pow(10.0, exponent(random)) * unit(random); };
  const auto position = [&] { return Vector3(far(), far(), far()); };
  int moved = 0;
  for (int k = 0; k < 20000; ++k) {
    Vector3 grab = position(), eye = position();
    if (k % 7 == 0) grab[k % 3] = std::numeric_limits<double>::infinity();
    const Cursor start{support::view_from(eye, grab + position()), Vector2(400 * unit(random), 300 * unit(random))};
    const MotionKind kind = std::array{MotionKind::Translate, MotionKind::Rotate, MotionKind::Scale}[k % 3];
    DragMotion m(kind, grab, k % 2 ? grab : position(), position(), start,
                 k % 5 ? std::nullopt : std::optional(position()));
    if (k % 4 == 0) m.hold(position());
    if (k % 4 == 1) m.toggle_lock(AxisLock::Z);
    Cursor next = k % 2 ? start : Cursor{support::view_from(eye, position()), start.pixel};
    next.pixel = Vector2(far(), far());
    next.snap = k % 11 == 0;
    m.move(next);
    if (k % 13 == 0) m.type('9');
    ASSERT_NO_THROW(resolve(m.transform(), grab)) << k << ": " << m.text();
    ASSERT_EQ(m.text().find("nan"), std::string::npos) << k << ": " << m.text();
    moved += m.moves() ? 1 : 0;
  }
  EXPECT_GT(moved, 1000);
}

TEST(DragKey, EachIsTheUsersToReadOnce) {
  EXPECT_EQ(std::size(kKeyHelp), static_cast<std::size_t>(DragKey::Help) - 8) << "digits have one row";
  std::set<DragKey> keys;
  std::set<std::string> names, sentences;
  for (const KeyHelp& help : kKeyHelp) {
    EXPECT_TRUE(keys.insert(help.key).second) << help.name;
    EXPECT_TRUE(names.insert(help.name).second) << help.name;
    EXPECT_TRUE(sentences.insert(help.does).second) << help.does;
    EXPECT_EQ(std::string(help.does).back(), '.');
  }
}

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
}  // namespace lapedit::drag_motion_test
