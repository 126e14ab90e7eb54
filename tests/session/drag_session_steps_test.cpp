// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "bodies.h"
#include "drag_support.h"
#include "lapedit/edit/fit_step.h"
#include "lapedit/mesh/vertex_finder.h"
#include "lapedit/session/drag_session.h"
#include "support.h"

// Regions, handles and steps of a dragging session.
namespace lapedit::drag_session_steps_test {
namespace {

using support::same_bits;
using support::Window;
using State = DragSession::State;

constexpr PressModifiers kAdd{true, false};
constexpr PressModifiers kTake{false, true};

TriangleMesh plate() {
  TriangleMesh mesh = shapes::grid(60, 60);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = 0.3 * std::sin(mesh.vertices(v, 0)) * std::cos(0.8 * mesh.vertices(v, 1));
  }
  return mesh;
}

constexpr int at(int i, int j) {
  return 60 * i + j;
}

constexpr int kMiddle = at(30, 30);

bool has(const std::vector<int>& set, int vertex) {
  return std::binary_search(set.begin(), set.end(), vertex);
}

// --- Presses ---------------------------------------------------------------------------------------------------------

TEST(DragPress, WaitsForNothingBeforeTheSurfaceCanBeSearched) {
  const TriangleMesh mesh = support::stored(plate());
  const Camera view = support::view_from_above(mesh.vertices);
  DragSession session(mesh, StoredScalar::Float, {});
  const Cursor cursor{view, view.pixel(mesh.vertices.row(kMiddle).transpose())};
  EXPECT_FALSE(session.press(cursor)) << "the view turns";
  session.release(cursor);
  session.wait();
  EXPECT_TRUE(session.selection().groups.empty());
  EXPECT_TRUE(session.press(cursor));
  session.release(cursor);
  EXPECT_TRUE(session.selection().groups.empty()) << "the radius of what stands out there is not known yet";
  session.wait();
  EXPECT_FALSE(session.selection().groups.empty());
}

TEST(DragPress, IsForgottenByEscBeforeItsRadiusIsKnown) {
  const TriangleMesh mesh = support::stored(plate());
  const Camera view = support::view_from_above(mesh.vertices);
  DragSession session(mesh, StoredScalar::Float, {});
  session.wait();
  const Cursor cursor{view, view.pixel(mesh.vertices.row(kMiddle).transpose())};
  EXPECT_TRUE(session.press(cursor));
  EXPECT_TRUE(session.key(DragKey::Cancel));
  session.move({view, cursor.pixel + Vector2(20, 0)});
  session.release({view, cursor.pixel + Vector2(20, 0)});
  session.wait();
  EXPECT_TRUE(session.selection().groups.empty());
}

TEST(DragPress, AfterAStepIsHandledOnceTheNewPoseCanBeSearched) {
  Window window(plate());
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(20, 10)));
  window.session.release(window.at(kMiddle, Vector2(20, 10)));
  while (window.session.figures().steps == 0) {
    window.session.poll();
  }
  EXPECT_FALSE(window.session.press(window.at(Vector2(1, 1)))) << "off the mesh";
  window.press(at(50, 50));
  window.session.release(window.at(at(50, 50)));
  window.session.wait();
  EXPECT_EQ(window.session.selection().groups, (std::vector<std::vector<int>>{{at(50, 50)}}));
  window.expect_consistent();
}

// --- Regions --------------------------------------------------------------------------------------------------------

TEST(DragRegion, SettingsOutOfRangeAreRefusedAndChangeNothing) {
  Window window(plate());
  window.click(kMiddle);
  const double radius = window.session.settings().radius;
  window.change([](DragSettings& s) { s.radius = -1; });
  EXPECT_TRUE(window.says("radius"));
  EXPECT_EQ(window.session.settings().radius, radius);
  window.change([](DragSettings& s) { s.edit.order = 2; });
  EXPECT_EQ(window.session.settings().edit.order, 1);
  EXPECT_TRUE(window.session.preparation().ready);
}

TEST(DragRegion, AnotherHandleInsideKeepsItOneOutsideDoesNot) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 8; });
  window.click(kMiddle);
  const std::vector<int> before = window.region();
  window.click(at(33, 31));
  EXPECT_EQ(window.region(), before);
  EXPECT_EQ(window.session.selection().groups, (std::vector<std::vector<int>>{{at(33, 31)}}));
  window.drag(at(33, 31), Vector2(30, 10));
  window.drag(at(29, 30), Vector2(0, 20));
  EXPECT_EQ(window.region(), before);
  window.session.key(DragKey::NewRegion);
  window.click(at(33, 31));
  EXPECT_NE(window.region(), before) << "another one is requested";
  window.click(at(50, 50));
  EXPECT_TRUE(has(window.region(), at(50, 50)));
  EXPECT_FALSE(has(window.region(), at(33, 31)));
  window.expect_consistent();
}

/// The paper's loop: anchors are settled with the first handle, so that the factor serves all others.
TEST(DragRegion, AnotherHandleFindsTheAnchorsAsTheyWere) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 8; });
  window.click(kMiddle);
  const KeptAnchors first = anchors_of(*window.session.shown().region());
  ASSERT_FALSE(first.empty());
  const auto expect_the_same = [&] {
    const KeptAnchors now = anchors_of(*window.session.shown().region());
    EXPECT_EQ(now.vertices, first.vertices);
    EXPECT_EQ(now.weights, first.weights);
    EXPECT_EQ(now.depths, first.depths);
    EXPECT_EQ(now.reach, first.reach);
  };
  window.drag(kMiddle, Vector2(10, 20));
  expect_the_same();
  window.drag(at(33, 31), Vector2(30, 10));
  expect_the_same();
  EXPECT_TRUE(window.session.recorded().steps[0].region.anchors.empty()) << "the first step has a radius";
  EXPECT_EQ(window.session.recorded().steps[1].region.anchors.vertices, first.vertices);
  window.undo();
  window.redo();
  expect_the_same();
  window.expect_consistent();
  // Another padding is another band.
  window.change([](DragSettings& s) { s.padding = 0.3; });
  EXPECT_GT(anchors_of(*window.session.shown().region()).vertices.size(), first.vertices.size());
  window.expect_consistent();
}

TEST(DragRegion, MadeByHandItIsNotLostByAClickOutside) {
  Window window(plate());
  std::vector<int> set;
  for (int i = 20; i < 40; ++i) {
    for (int j = 20; j < 40; ++j) {
      set.push_back(at(i, j));
    }
  }
  window.session.set_region(set);
  ASSERT_NE(window.session.shown().region(), nullptr);
  EXPECT_EQ(window.region(), set);
  EXPECT_EQ(window.session.state(), State::Idle);
  window.click(at(50, 50));
  EXPECT_TRUE(window.says("outside the region"));
  EXPECT_EQ(window.region(), set);
  window.drag(at(50, 50), Vector2(40, 0));
  EXPECT_EQ(window.session.figures().steps, 0);
  window.drag(kMiddle, Vector2(25, 0));
  EXPECT_EQ(window.region(), set);
  EXPECT_EQ(window.session.figures().steps, 1);
  window.expect_consistent();
}

TEST(DragRegion, BrushAddsAndTakesWhatIsUnderIt) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 5; });
  window.click(kMiddle);
  const std::vector<int> before = window.region();
  ASSERT_FALSE(has(before, at(45, 30)));
  const Vector2 to_the_right = window.at(at(45, 30)).pixel - window.at(kMiddle).pixel;
  window.drag(kMiddle, to_the_right, kAdd);
  const std::vector<int> larger = window.region();
  EXPECT_TRUE(has(larger, at(45, 30)));
  EXPECT_TRUE(std::includes(larger.begin(), larger.end(), before.begin(), before.end()));
  EXPECT_EQ(window.session.selection().groups, (std::vector<std::vector<int>>{{kMiddle}}));
  window.drag(at(45, 30), Vector2(3, 3), kTake);
  EXPECT_FALSE(has(window.region(), at(45, 30)));
  EXPECT_TRUE(has(window.region(), kMiddle));
  // The handle is not brushed away.
  window.drag(kMiddle, Vector2(5, 5), kTake);
  EXPECT_TRUE(has(window.region(), kMiddle));
  EXPECT_EQ(window.session.figures().steps, 0);
  EXPECT_EQ(window.poses(), 0);
}

TEST(DragRegion, KeysEndAStroke) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 5; });
  window.click(kMiddle);
  window.press(at(33, 30), kAdd);
  window.session.move(window.at(at(40, 30)));
  window.keys("tx5");
  window.session.move(window.at(at(45, 30)));
  EXPECT_EQ(window.session.state(), State::Dragging);
  const std::vector<int> region = window.region();
  window.session.release(window.at(at(45, 30)));
  window.keys("\r");
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_EQ(window.region(), region);
  EXPECT_TRUE(has(region, at(40, 30)));
  EXPECT_EQ(window.session.figures().steps, 1);
  window.expect_consistent();
}

TEST(DragRegion, BrushMakesARegionWithoutTheFarSide) {
  const TriangleMesh sphere = shapes::icosphere(4);
  Window window(sphere, support::view_from(Vector3(5, 0, 0), Vector3::Zero()));
  window.change([](DragSettings& s) { s.brush_pixels = 500; });
  const int front = support::vertex_at(sphere, Vector3::UnitX());
  window.drag(front, Vector2(5, 0), kAdd);
  ASSERT_NE(window.session.shown().region(), nullptr);
  EXPECT_GT(window.region().size(), 100U);
  for (const int v : window.region()) {
    EXPECT_GT(window.host()(v, 0), 0.1);
  }
}

TEST(DragRegion, GrowsAndShrinksByARingAndGrowsToTheComponent) {
  Window window(plate());
  window.session.whole_component();
  EXPECT_TRUE(window.says("no handle"));
  window.change([](DragSettings& s) { s.radius = 5; });
  window.click(kMiddle);
  const std::vector<int> before = window.region();
  window.session.key(DragKey::Grow);
  window.session.wait();
  EXPECT_GT(window.region().size(), before.size());
  window.session.key(DragKey::Shrink);
  window.session.wait();
  EXPECT_EQ(window.region(), before);
  EXPECT_TRUE(window.session.preparation().ready);
  window.session.whole_component();
  window.session.wait();
  EXPECT_EQ(window.region().size(), 3600U);
  EXPECT_EQ(window.session.shown().region()->count(VertexClass::Anchor), 0);
}

TEST(DragRegion, HandleAloneIsRefusedWithALine) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 1e-3; });
  window.click(kMiddle);
  EXPECT_TRUE(window.says("handle alone"));
  EXPECT_EQ(window.log.size(), 1U);
  window.drag(kMiddle, Vector2(30, 30));
  EXPECT_EQ(window.session.figures().steps, 0);
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
  window.change([](DragSettings& s) { s.radius = 5; });
  window.drag(kMiddle, Vector2(30, 30));
  EXPECT_EQ(window.session.figures().steps, 1);
}

// --- Handles --------------------------------------------------------------------------------------------------------

TEST(DragHandle, ClicksAddAndTakeVertices) {
  Window window(plate());
  window.click(kMiddle);
  window.click(at(31, 31), kAdd);
  window.click(at(30, 32), kAdd);
  EXPECT_EQ(window.session.selection().groups, (std::vector<std::vector<int>>{{at(30, 30), at(30, 32), at(31, 31)}}));
  window.click(at(30, 32), kTake);
  EXPECT_EQ(window.session.selection().groups, (std::vector<std::vector<int>>{{at(30, 30), at(31, 31)}}));
  window.drag(at(31, 31), Vector2(20, 20));
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_LT((way.row(at(30, 30)) - way.row(at(31, 31))).norm(), 0.01 * way.row(at(30, 30)).norm());
  window.expect_consistent();
}

TEST(DragHandle, SeveralGroupsMoveIndependently) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 12; });
  window.click(kMiddle);
  window.session.key(DragKey::NextGroup);
  window.click(at(36, 30));
  ASSERT_EQ(window.session.selection().groups.size(), 2U);
  EXPECT_EQ(window.session.selection().active, 1);
  window.drag(at(36, 30), Vector2(0, 30));
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_LT(way.row(kMiddle).norm(), 0.01 * way.row(at(36, 30)).norm());
  window.drag(kMiddle, Vector2(0, -30));
  EXPECT_EQ(window.session.selection().active, 0);
  EXPECT_EQ(window.session.selection().groups.size(), 2U);
  EXPECT_EQ(window.session.recorded().steps.at(1).handles.size(), 2U);
  window.expect_consistent();
}

TEST(DragHandle, CurveIsJoinedByShortestPathsAndMovesAsOne) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 15; });
  window.session.set(&Tools::mode, HandleMode::Curve);
  window.click(at(25, 30));
  window.click(at(35, 30));
  ASSERT_EQ(window.session.selection().groups.size(), 1U);
  const std::vector<int> curve = window.session.selection().groups[0];
  EXPECT_EQ(curve.size(), 11U);
  for (int i = 25; i <= 35; ++i) {
    EXPECT_TRUE(has(curve, at(i, 30)));
  }
  window.click(at(35, 34));
  EXPECT_EQ(window.session.selection().groups[0].size(), 15U);
  window.drag(at(30, 30), Vector2(0, 25));
  EXPECT_EQ(window.session.figures().steps, 1);
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_LT((way.row(at(25, 30)) - way.row(at(35, 34))).norm(), 0.01 * way.row(at(25, 30)).norm());
  window.expect_consistent();
}

/// Three groups in a row, the middle one chosen last.
void take_three(Window& window) {
  window.change([](DragSettings& s) { s.radius = 14; });
  window.click(at(26, 30));
  for (const int next : {at(34, 30), at(30, 34)}) {
    window.session.key(DragKey::NextGroup);
    window.click(next);
  }
  ASSERT_EQ(window.session.selection().groups.size(), 3U);
}

TEST(DragHandles, ShiftClickChoosesGroupsThatMoveTogether) {
  Window window(plate());
  take_three(window);
  window.click(at(26, 30), kTake);
  EXPECT_TRUE(window.session.selection().moves(0));
  EXPECT_FALSE(window.session.selection().moves(1));
  EXPECT_TRUE(window.session.selection().moves(2));
  EXPECT_EQ(window.session.selection().groups.size(), 3U) << "a vertex was taken away";
  EXPECT_TRUE(window.says("2 of 3 move together")) << window.session.message();
  window.drag(at(30, 34), Vector2(20, 25));
  const EditStep step = window.session.recorded().steps.at(0);
  EXPECT_FALSE(step.handles[0].transform.translation.isZero());
  EXPECT_EQ(step.handles[0].transform.translation, step.handles[2].transform.translation);
  EXPECT_TRUE(step.handles[1].transform.translation.isZero(0));
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_LT((way.row(at(26, 30)) - way.row(at(30, 34))).norm(), 0.01 * way.row(at(30, 34)).norm());
  EXPECT_LT(way.row(at(34, 30)).norm(), 0.01 * way.row(at(30, 34)).norm());
  window.expect_consistent();
  // Undone, the same groups are chosen; a plain press on one that holds moves it alone.
  window.undo();
  EXPECT_TRUE(window.session.selection().moves(0) && !window.session.selection().moves(1) &&
              window.session.selection().moves(2));
  window.drag(at(34, 30), Vector2(0, 20));
  EXPECT_TRUE(!window.session.selection().moves(0) && window.session.selection().moves(1) &&
              !window.session.selection().moves(2));
  window.expect_consistent();
}

TEST(DragHandles, ChosenGroupsRotateAboutTheirCommonCentre) {
  Window window(plate());
  take_three(window);
  window.click(at(26, 30), kTake);
  window.click(at(34, 30), kTake);
  window.click(at(30, 34), kTake);  // lets it hold
  EXPECT_TRUE(window.session.selection().moves(0) && window.session.selection().moves(1) &&
              !window.session.selection().moves(2));
  window.keys("rz90\r");
  const EditStep step = window.session.recorded().steps.at(0);
  ASSERT_TRUE(step.handles[0].transform.center);
  const Vector3 middle =
      (window.session.original().vertices.row(at(26, 30)) + window.session.original().vertices.row(at(34, 30)))
          .transpose() /
      2;
  EXPECT_LT((*step.handles[0].transform.center - middle).norm(), 1e-9);
  EXPECT_EQ(step.handles[0].transform.degrees, 90);
  EXPECT_EQ(step.handles[1].transform.center, step.handles[0].transform.center);
  EXPECT_EQ(step.handles[2].transform.degrees, 0);
  const Vector3 before = window.session.original().vertices.row(at(26, 30)).transpose() - middle;
  const Vector3 after = window.host().row(at(26, 30)).transpose() - middle;
  EXPECT_LT((after - Vector3(-before.y(), before.x(), before.z())).norm(), 0.05);
  window.expect_consistent();
}

/// A curve through three points, 5 vertices apart.
void draw_mouth(Window& window) {
  window.change([](DragSettings& s) { s.radius = 15; });
  window.session.set(&Tools::mode, HandleMode::Curve);
  for (const int v : {at(25, 30), at(30, 30), at(35, 30)}) {
    window.click(v);
  }
  ASSERT_EQ(window.session.selection().groups.size(), 1U);
  ASSERT_EQ(window.session.selection().discs.curves[0].points.size(), 3U);
}

TEST(DragCurve, BendsByAPointWhileTheOthersHold) {
  Window window(plate());
  draw_mouth(window);
  const Points rest = window.session.original().vertices;
  window.drag(at(35, 30), Vector2(0, -30));
  const HandleGroup handle = window.session.recorded().steps.at(0).handles.at(0);
  ASSERT_EQ(handle.targets.size(), 11U);
  std::vector<double> up;
  for (int i = 25; i <= 35; ++i) {
    const auto k = static_cast<std::size_t>(std::find(handle.vertices.begin(), handle.vertices.end(), at(i, 30)) -
                                            handle.vertices.begin());
    up.push_back((handle.targets[k] - rest.row(at(i, 30)).transpose()).y());
  }
  for (int i = 0; i <= 5; ++i) {
    EXPECT_EQ(up[i], 0) << i;
  }
  for (int i = 6; i <= 10; ++i) {
    EXPECT_GT(up[i], up[i - 1]) << i;
    EXPECT_GT(up[i] - up[i - 1], i > 6 ? up[i - 1] - up[i - 2] : 0) << i;  // turns up more and more towards its end
  }
  EXPECT_NEAR(window.host()(at(35, 30), 1) - rest(at(35, 30), 1), up[10], 0.02 * up[10]);
  window.expect_consistent();
  // The curve still bends, by another point: a smile.
  window.drag(at(25, 30), Vector2(0, -30));
  EXPECT_EQ(window.session.recorded().steps.at(1).handles.at(0).targets.size(), 11U);
  EXPECT_GT(window.host()(at(25, 30), 1) - rest(at(25, 30), 1), 0.9 * up[10]);
  EXPECT_LT(std::abs(window.host()(at(30, 30), 1) - rest(at(30, 30), 1)), 0.02 * up[10]);
  window.expect_consistent();
  // Solved again with other settings, and taken back with its points.
  window.change([](DragSettings& s) { s.edit.membrane = 100; });
  window.expect_consistent();
  window.undo(2);
  EXPECT_TRUE(same_bits(window.host(), rest));
  EXPECT_EQ(window.session.selection().discs.curves[0].points.size(), 3U);
}

TEST(DragCurve, SmilesOnBothSidesOfAPlane) {
  Window window(shapes::grid(61, 61));
  window.change([](DragSettings& s) { s.radius = 15; });
  window.session.set(&Tools::mirror, MirrorPlane{Vector3(30, 0, 0), Vector3::UnitX()});
  window.session.set(&Tools::mode, HandleMode::Curve);
  const auto position = [&](int x, int y) { return support::vertex_at(window.session.original(), Vector3(x, y, 0)); };
  for (const int x : {24, 30, 36}) {
    window.click(position(x, 30));
  }
  window.drag(position(36, 30), Vector2(10, -30));
  ASSERT_EQ(window.session.figures().steps, 1) << window.session.message();
  EXPECT_TRUE(window.session.recorded().steps[0].mirror);
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_GT(way(position(36, 30), 1), 0.5);
  EXPECT_GT(way(position(36, 30), 0), 0.1);
  EXPECT_NEAR(way(position(24, 30), 1), way(position(36, 30), 1), 1e-3);  // diagonals of the grid are not symmetric
  EXPECT_NEAR(way(position(24, 30), 0), -way(position(36, 30), 0), 1e-3);
  EXPECT_LT(way.row(position(30, 30)).norm(), 0.05);
  window.expect_consistent();
}

TEST(DragCurve, PressBetweenItsPointsMovesAllOfIt) {
  Window window(plate());
  draw_mouth(window);
  window.drag(at(33, 30), Vector2(0, -30));
  EXPECT_TRUE(window.session.recorded().steps.at(0).handles.at(0).targets.empty());
  // Bent by keys: the amount is the point's, and R turns the curve as a whole.
  window.press(at(35, 30));
  window.session.move(window.at(at(35, 30), Vector2(0, -10)));
  window.keys("y2\r");
  const HandleGroup bent = window.session.recorded().steps.at(1).handles.at(0);
  ASSERT_EQ(bent.targets.size(), 11U);
  window.expect_consistent();
}

TEST(DragCurve, NextPieceIsShownAsTheClickTakesIt) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 15; });
  window.session.set(&Tools::mode, HandleMode::Curve);
  window.click(at(25, 30));
  ASSERT_TRUE(window.hovered(window.at(at(31, 33))));
  const Points shown = window.session.hover()->path;
  window.click(at(31, 33));
  const std::vector<int>& path = window.session.selection().discs.curves[0].path;
  ASSERT_EQ(shown.rows(), static_cast<Eigen::Index>(path.size()));
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(shown.row(static_cast<Eigen::Index>(i)), window.session.mesh().vertices.row(path[i])) << i;
  }
  ASSERT_TRUE(window.hovered(window.at(at(31, 33))));
  ASSERT_TRUE(window.session.hover()->curve_point);
  EXPECT_EQ(window.session.hover()->path.rows(), 0);
}

// --- Steps ----------------------------------------------------------------------------------------------------------

TEST(DragSteps, UndoAndRedoAreExact) {
  Window window(plate());
  std::vector<Points> states{window.host()};
  for (const int vertex : {kMiddle, at(32, 28), at(50, 50)}) {
    window.drag(vertex, Vector2(20, 12));
    states.push_back(window.host());
  }
  for (int k = 2; k >= 0; --k) {
    window.undo();
    EXPECT_TRUE(same_bits(window.host(), states[k])) << k;
  }
  EXPECT_FALSE(window.session.can_undo());
  window.session.undo();
  EXPECT_TRUE(window.says("nothing to undo"));
  for (int k = 1; k <= 3; ++k) {
    window.redo();
    EXPECT_TRUE(same_bits(window.host(), states[k])) << k;
  }
  window.expect_consistent();
  window.session.go_to(0);
  EXPECT_TRUE(same_bits(window.host(), states[0]));
  EXPECT_TRUE(window.session.can_redo());
}

TEST(DragSteps, GoingBackPreparesOnceHoweverManyStepsItUndoes) {
  Window window(plate());
  for (const int x : {10, 20, -30}) {
    window.drag(kMiddle, Vector2(x, 5));
  }
  const Points edited = window.host();
  const auto prepared = [&](const auto& change) {  // each preparation shows its region
    const int before = window.session.shown().region_serial();
    change();
    const int after = window.session.shown().region_serial();
    window.session.wait();
    return after - before;
  };
  const int one = prepared([&] { window.session.undo(); });
  window.redo();
  EXPECT_EQ(prepared([&] { window.session.go_to(0); }), one);
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
  EXPECT_EQ(prepared([&] { window.session.go_to(3); }), one);
  EXPECT_TRUE(same_bits(window.host(), edited));
  window.expect_consistent();
}

TEST(DragSteps, UndoGoesBackToHandleAndRegionOfTheStep) {
  Window window(plate());
  window.drag(kMiddle, Vector2(20, 12));
  const std::vector<int> region = window.region();
  window.drag(at(50, 50), Vector2(20, 12));
  window.undo(2);
  EXPECT_EQ(window.session.selection().groups, (std::vector<std::vector<int>>{{kMiddle}}));
  EXPECT_EQ(window.region(), region);
  window.drag(kMiddle, Vector2(-10, 5));
  EXPECT_FALSE(window.session.can_redo());
  window.expect_consistent();
}

TEST(DragSteps, OtherSettingsSolveTheLastStepAgain) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  const Points stiff = window.host();
  window.change([](DragSettings& s) { s.edit.membrane = 50; });
  EXPECT_FALSE(same_bits(window.host(), stiff));
  EXPECT_EQ(window.session.figures().steps, 1);
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.membrane, 50);
  window.expect_consistent();
  window.change([](DragSettings& s) { s.padding = 0.3; });
  EXPECT_EQ(window.session.recorded().steps.at(0).region.padding, 0.3);
  window.change([](DragSettings& s) { s.radius *= 1.5; });
  window.expect_consistent();
  window.change([](DragSettings& s) {
    s.radius /= 1.5;
    s.padding = 0.1;
    s.edit.membrane = 500;
  });
  EXPECT_TRUE(same_bits(window.host(), stiff));
  window.undo();  // settings are not undone
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
}

TEST(DragSteps, WhatFollowedAStepIsGoneOnceTheStepIsSolvedAgain) {
  Window window(plate());
  for (const int vertex : {kMiddle, at(32, 28)}) {
    window.drag(vertex, Vector2(20, 12));
  }
  window.undo(2);
  window.redo();
  ASSERT_TRUE(window.session.can_redo());
  window.change([](DragSettings& s) { s.edit.membrane = 50; });
  const Points adjusted = window.host();
  EXPECT_FALSE(window.session.can_redo());
  window.session.redo();
  EXPECT_TRUE(window.says("nothing to redo"));
  EXPECT_TRUE(same_bits(window.host(), adjusted));
  window.expect_consistent();
}

TEST(DragSteps, OtherSettingsLeaveTheLastStepAloneOnceSomethingElseIsPicked) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  const Points before = window.host();
  window.click(at(32, 30));
  window.change([](DragSettings& s) { s.edit.membrane = 50; });
  EXPECT_TRUE(same_bits(window.host(), before));
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.membrane, 500);
}

TEST(DragSteps, OtherSettingsSolveTheDragInProgressAgain) {
  Window window(plate());
  window.click(kMiddle);
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(40, 0)));
  window.session.wait();
  const Points before = window.host();
  window.change([](DragSettings& s) { s.edit.membrane = 50; });
  EXPECT_EQ(window.session.state(), State::Dragging);
  EXPECT_FALSE(same_bits(window.host(), before));
  window.change([](DragSettings& s) { s.radius *= 0.5; });
  window.session.release(window.at(kMiddle, Vector2(40, 0)));
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.membrane, 50);
  window.expect_consistent();
}

TEST(DragSteps, SettingsMayChangeWhileAStepIsSolvedForAgain) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  window.drag(at(32, 30), Vector2(20, 10));  // its region is a set of vertices, for which the radius means nothing
  DragSettings settings = window.session.settings();
  settings.edit.membrane = 50;
  window.session.set_settings(settings);
  ASSERT_EQ(window.session.state(), State::Settling);
  settings.radius *= 1.5;
  window.session.set_settings(settings);
  // And what the mouse does meanwhile is not lost.
  window.drag(at(28, 30), Vector2(0, 20));
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_EQ(window.session.figures().steps, 3);
  EXPECT_EQ(window.session.recorded().steps.at(1).settings.membrane, 50);
  window.expect_consistent();
}

TEST(DragSteps, ButtonReleasedWhileAStepIsSolvedForAgainHoldsNothing) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  window.press(kMiddle);
  DragSettings settings = window.session.settings();
  settings.edit.membrane = 50;
  window.session.set_settings(settings);
  ASSERT_EQ(window.session.state(), State::Settling);
  window.session.release(window.at(kMiddle));
  window.session.wait();
  window.session.move(window.at(kMiddle, Vector2(30, 30)));
  EXPECT_EQ(window.session.state(), State::Picked);
}

/// What is dropped while the worker is elsewhere leaves the step, and what settings are about.
TEST(DragSteps, AdjustmentAndLoadCanBeDropped) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  const Points before = window.host();
  DragSettings settings = window.session.settings();
  settings.edit.membrane = 50;
  window.session.set_settings(settings);
  ASSERT_EQ(window.session.state(), State::Settling);
  window.session.cancel();
  window.session.wait();
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_TRUE(window.session.preparation().ready);
  EXPECT_TRUE(same_bits(window.host(), before));
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.membrane, 500);

  window.session.load(window.session.recorded());
  ASSERT_EQ(window.session.state(), State::Settling);
  window.session.cancel();
  window.session.wait();
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_TRUE(window.session.preparation().ready);
  EXPECT_TRUE(same_bits(window.host(), before));

  window.change([](DragSettings& s) { s.edit.membrane = 20; });
  EXPECT_EQ(window.session.figures().steps, 1);
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.membrane, 20);
  window.expect_consistent();
}

TEST(DragSteps, SavedEditLoadsToTheSameBits) {
  Window window(plate());
  window.change([](DragSettings& s) { s.radius = 3; });
  window.drag(at(15, 15), Vector2(40, 25));
  window.drag(at(45, 45), Vector2(10, -25));  // in another region
  Window other(plate());
  other.session.load(window.session.recorded());
  EXPECT_EQ(other.session.state(), State::Settling);
  other.session.wait();
  EXPECT_EQ(other.session.state(), State::Picked);
  EXPECT_TRUE(same_bits(other.host(), window.host()));
  EXPECT_EQ(other.session.figures().steps, 2);
  other.expect_consistent();
  other.session.undo();
  other.session.undo();  // of the first the host learns only now
  EXPECT_TRUE(same_bits(other.host(), other.session.original().vertices));
}

/// A saved fit loads to the bits of a replay, and drags follow it.
TEST(DragSteps, LoadedFitIsAStepAmongOthers) {
  TriangleMesh scan = shapes::head(0.1);
  scan.vertices.col(0) *= 1.1;
  Edit edit;
  edit.steps.emplace_back().fit.emplace().to = "scan";
  edit.steps[0].region.kind = RegionSpec::Kind::Component;
  const auto reader = [&scan](const FitStep&) { return ScanData{scan, {}}; };
  Window window(shapes::head(0.11));
  window.session.load(with_scans(edit, reader));
  window.session.wait();
  ASSERT_EQ(window.session.figures().steps, 1) << window.session.message();
  EXPECT_EQ(window.session.timeline().done()[0].name, "Fit to a scan");
  EXPECT_TRUE(window.says("Press on the surface")) << window.session.message();
  const TriangleMesh& mesh = window.session.original();
  const Points fitted = support::edited(mesh, apply_edit(mesh, with_scans(edit, reader), 1, StoredScalar::Float));
  EXPECT_TRUE(same_bits(window.host(), fitted));
  EXPECT_EQ(window.session.selection().active, static_cast<int>(window.session.selection().groups.size()) - 1);
  window.drag(nearest_vertex(mesh, Vector3(0, 1.3, 0)), Vector2(10, 30));
  window.expect_consistent();
  EXPECT_EQ(window.session.recorded().steps.at(0).fit->to, "scan");
  window.undo(1);
  EXPECT_TRUE(same_bits(window.host(), fitted));
  window.undo(1);
  EXPECT_TRUE(same_bits(window.host(), mesh.vertices));
}

TEST(DragSteps, AreSavedAndPaintedVerticesStayAfterOtherCodeChangedTheMesh) {
  Window before(plate());
  before.click(kMiddle);
  before.session.set_region(before.region());
  before.session.wait();
  before.session.set_anchors({at(26, 30), at(2, 2)});
  before.session.wait();
  before.change([](DragSettings& s) { s.radius = 3; });
  before.drag(kMiddle, Vector2(10, 5));
  const auto succeed = [](const DragSession& old, const TriangleMesh& mesh) {
    auto next = std::make_unique<Window>(mesh);
    next->session.inherit(old.inheritance());
    return next;
  };
  TriangleMesh smoothed = before.session.mesh();
  smoothed.vertices.col(2) *= 0.5;
  const auto after = succeed(before.session, smoothed);
  EXPECT_TRUE(after->says("1 step cannot be undone"));
  EXPECT_EQ(after->session.settings().radius, 3);
  EXPECT_FALSE(after->session.can_undo());
  EXPECT_TRUE(after->session.selection().by_hand);
  EXPECT_TRUE(has(after->session.selection().held, at(2, 2)));
  EXPECT_EQ(after->region(), before.region());
  EXPECT_EQ(after->session.saved().steps.size(), 1U);
  // Another change without steps in between loses nothing more.
  const auto third = succeed(after->session, smoothed);
  EXPECT_EQ(third->session.saved().steps.size(), 1U);
  third->drag(kMiddle, Vector2(5, 5));
  EXPECT_EQ(third->session.saved().steps.at(0).region.held, third->session.selection().held);
  third->expect_consistent();
  third->undo();
  EXPECT_TRUE(third->session.can_save());
  const auto other = succeed(before.session, shapes::grid(9, 9));
  EXPECT_TRUE(other->session.selection().held.empty());
  EXPECT_FALSE(other->session.selection().has_region);
  EXPECT_TRUE(other->session.can_save());
}

TEST(DragSteps, EditOfAnotherMeshIsRefused) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  Window other(shapes::grid(20, 20));
  other.session.load(window.session.recorded());
  other.session.wait();
  EXPECT_EQ(other.session.state(), State::Idle);
  EXPECT_TRUE(other.says("made for a mesh of 3600 vertices"));
  EXPECT_TRUE(same_bits(other.host(), other.session.original().vertices));
}

TEST(DragSteps, EachAppliedStepIsLoggedInOneLine) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  ASSERT_EQ(window.log.size(), 1U);
  for (const char* expected : {"step 1", "Moving by", "1 vertex (1830)", "region of", "ms"}) {
    EXPECT_NE(window.log[0].find(expected), std::string::npos) << window.log[0];
  }
}

TEST(DragSteps, FiguresTellOfTheLastStep) {
  Window window(plate());
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(60, 0)));
  window.session.wait();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!window.session.figures().largest_stretch && std::chrono::steady_clock::now() < deadline) {
    window.session.poll();  // the report is made when the mouse pauses
  }
  const DragFigures figures = window.session.figures();
  EXPECT_GT(figures.largest_stretch.value_or(0), 0.01);
  EXPECT_GT(figures.handle_error.value_or(0), 0);
  EXPECT_LT(figures.handle_error.value_or(1), 0.1);
  EXPECT_EQ(figures.handle, 1);
  EXPECT_EQ(figures.handle + figures.free + figures.anchors + figures.fixed, 3600);
  EXPECT_GT(figures.prepare_ms.value_or(0), 0);
  EXPECT_GT(figures.solve_ms.value_or(0), 0);
  // The next region is ready, and what was released is still told of.
  window.session.release(window.at(kMiddle, Vector2(90, 0)));
  window.session.wait();
  EXPECT_GT(window.session.figures().largest_stretch.value_or(0), *figures.largest_stretch);
  // Of another handle nothing is known before it is moved.
  window.click(kMiddle + 3);
  EXPECT_FALSE(window.session.figures().largest_stretch || window.session.figures().solve_ms);
}

/// The middle dragged over the region's boundary: the plate folds there.
TEST(DragSteps, AdviceIsGivenWhereAStepFolded) {
  Window window(plate());
  window.change([](DragSettings& s) {
    s.edit = EditSettings::of(EditMethod::Paper);
    s.edit.method = EditMethod::Linear;
  });
  window.drag(kMiddle, Vector2(20, 10));
  ASSERT_EQ(window.log.size(), 1U);
  EXPECT_EQ(window.log[0].find("folded"), std::string::npos);
  EXPECT_EQ(window.session.figures().advice, "");
  window.session.undo();
  window.drag(kMiddle, Vector2(250, 10));
  const std::string advice = window.session.figures().advice;
  EXPECT_NE(advice.find("folded over near vertex"), std::string::npos);
  EXPECT_EQ(window.log.back().substr(window.log.back().size() - advice.size() - 2), "; " + advice);
  Window other(plate());
  other.session.load(window.session.recorded());
  other.session.wait();
  ASSERT_EQ(other.log.size(), 2U);
  EXPECT_EQ(other.log.back(), "step 1 of the saved edit: " + advice);
}

// --- The last step stays open ---------------------------------------------------------------------------------------

TEST(DragLastStep, TakesNumbersAndAFraction) {
  Window window(plate());
  window.click(kMiddle);
  EXPECT_FALSE(window.session.last_step());
  window.session.set_last_step(HandleTransform(), 1);
  EXPECT_TRUE(window.says("no last step"));
  window.keys("tz4\r");
  ASSERT_TRUE(window.session.last_step());
  EXPECT_EQ(window.session.last_step()->motion.translation, Vector3(0, 0, 4));
  const double rest = window.session.original().vertices(kMiddle, 2);
  HandleTransform motion = window.session.last_step()->motion;
  window.session.set_last_step(motion, 0.25);
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps.size(), 1U);
  EXPECT_EQ(window.session.recorded().steps[0].handles[0].transform.translation, Vector3(0, 0, 1));
  EXPECT_NEAR(window.host()(kMiddle, 2) - rest, 1, 0.02);
  EXPECT_EQ(window.session.last_step()->motion.translation, Vector3(0, 0, 4)) << "the whole displacement is kept";
  window.expect_consistent();
  motion.translation = Vector3(1, 0, 2);
  window.session.set_last_step(motion, 1);
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps[0].handles[0].transform.translation, Vector3(1, 0, 2));
  window.expect_consistent();
  // A fraction stays one when settings change, and comes back with undo and redo.
  window.session.set_last_step(motion, 0.5);
  window.session.wait();
  window.change([](DragSettings& s) { s.edit.membrane = 100; });
  EXPECT_EQ(window.session.last_step()->fraction, 0.5);
  window.expect_consistent();
  while (window.session.can_undo()) {
    window.session.undo();
  }
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
  while (window.session.can_redo()) {
    window.session.redo();
  }
  window.session.wait();
  EXPECT_EQ(window.session.last_step()->fraction, 0.5);
  // Fraction 0 moves nothing, to the bit; and all of it can be applied again.
  window.session.set_last_step(motion, 0);
  window.session.wait();
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
  window.session.set_last_step(motion, 1);
  window.session.wait();
  EXPECT_NEAR(window.host()(kMiddle, 2) - rest, 2, 0.02);
  window.expect_consistent();
  window.click(at(32, 30));
  EXPECT_FALSE(window.session.last_step());
}

TEST(DragLastStep, IsShownWhileItChangesAndAppliedAtTheEnd) {
  Window window(plate());
  window.click(kMiddle);
  window.keys("tz4\r");
  const double rest = window.session.original().vertices(kMiddle, 2);
  const Points before = window.host();
  const HandleTransform motion = window.session.last_step()->motion;
  for (const double fraction : {0.9, 0.7, 0.5}) {
    window.session.set_last_step(motion, fraction, true);
    window.session.wait();
    EXPECT_NEAR(window.host()(kMiddle, 2) - rest, 4 * fraction, 0.05);
    EXPECT_FALSE(window.settled());
    EXPECT_EQ(window.session.recorded().steps[0].handles[0].transform.translation, Vector3(0, 0, 4));
  }
  window.session.cancel();
  window.session.wait();
  EXPECT_TRUE(same_bits(window.host(), before));
  window.expect_consistent();
  window.session.set_last_step(motion, 0.5, true);
  window.session.set_last_step(motion, 0.5);
  window.session.wait();
  EXPECT_TRUE(window.settled());
  EXPECT_EQ(window.session.recorded().steps[0].handles[0].transform.translation, Vector3(0, 0, 2));
  window.expect_consistent();
}

TEST(DragLastStep, OfABentCurveAndOfSeveralHandlesAndOnBothSides) {
  Window bent(plate());
  draw_mouth(bent);
  bent.drag(at(35, 30), Vector2(0, -30));
  ASSERT_TRUE(bent.session.last_step());
  EXPECT_TRUE(bent.session.last_step()->bent);
  const double whole = bent.host()(at(35, 30), 1) - bent.session.original().vertices(at(35, 30), 1);
  bent.session.set_last_step(HandleTransform(), 0.5);
  bent.session.wait();
  EXPECT_NEAR(bent.host()(at(35, 30), 1) - bent.session.original().vertices(at(35, 30), 1), whole / 2, 0.02 * whole);
  bent.expect_consistent();

  Window several(plate());
  take_three(several);
  several.click(at(26, 30), kTake);
  several.keys("rz90\r");
  several.session.set_last_step(several.session.last_step()->motion, 0.5);
  several.session.wait();
  EXPECT_EQ(several.session.recorded().steps[0].handles[0].transform.degrees, 45);
  EXPECT_EQ(several.session.recorded().steps[0].handles[1].transform.degrees, 0);
  several.expect_consistent();

  Window both(shapes::grid(61, 61));
  both.session.set(&Tools::mirror, MirrorPlane{Vector3(30, 0, 0), Vector3::UnitX()});
  const int right = support::vertex_at(both.session.original(), Vector3(38, 30, 0)),
            left = support::vertex_at(both.session.original(), Vector3(22, 30, 0));
  both.click(right);
  both.keys("tz4\r");
  both.session.set_last_step(both.session.last_step()->motion, 0.5);
  both.session.wait();
  EXPECT_NEAR(both.host()(right, 2), 2, 0.02);
  EXPECT_NEAR(both.host()(left, 2), 2, 0.02);
  both.expect_consistent();
}

TEST(DragLastStep, RefusesWhatItCannotDo) {
  Window window(plate());
  window.click(kMiddle);
  window.keys("tz4\r");
  const Points before = window.host();
  HandleTransform motion = window.session.last_step()->motion;
  EXPECT_TRUE(window.session.last_step()->single);
  motion.degrees = 10;
  window.session.set_last_step(motion, 1);
  EXPECT_TRUE(window.says("Turning needs a handle of several vertices"));
  motion = HandleTransform();
  motion.scale = 0;
  window.session.set_last_step(motion, 1);
  EXPECT_TRUE(window.says("greater than 0"));
  window.session.set_last_step(HandleTransform(), 1.5);
  EXPECT_TRUE(window.says("from 0 to 1"));
  window.session.wait();
  EXPECT_TRUE(same_bits(window.host(), before));
}

}  // namespace
}  // namespace lapedit::drag_session_steps_test
