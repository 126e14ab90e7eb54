// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>

#include "drag_support.h"
#include "play.h"

namespace lapedit::drag_session_test {
namespace {

using support::kMiddle;
using support::play;
using support::same_bits;
using support::Window;
using State = DragSession::State;

TriangleMesh hills() {
  TriangleMesh mesh = shapes::grid(60, 60);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const Vector3 p = mesh.vertices.row(v).transpose();
    mesh.vertices(v, 2) = std::sin(0.9 * p.x()) * std::cos(0.7 * p.y());
  }
  return mesh;
}

TEST(DragSession, PressDragReleaseBringsTheVertexUnderTheCursor) {
  Window window(hills());
  const Vector2 target = window.at(kMiddle).pixel + Vector2(60, -40);
  window.drag(kMiddle, Vector2(60, -40));
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_EQ(window.session.recorded().steps.size(), 1U);
  EXPECT_LT((window.at(kMiddle).pixel - target).norm(), 0.1);
  EXPECT_TRUE(window.settled());
  window.expect_consistent();
  std::vector<int> fixed(3600);
  std::iota(fixed.begin(), fixed.end(), 0);
  fixed = without(fixed, window.region());
  EXPECT_GT(fixed.size(), 100U);
  EXPECT_EQ(support::rows(window.host(), fixed), support::rows(window.session.original().vertices, fixed));
}

TEST(DragSession, ReleaseBeforeTheRegionIsReadyGivesTheSameBits) {
  support::Play prepared(hills()), at_once(hills());
  at_once.run("press 30,30; move 30,30 60 -40; release 30,30 60 -40; state settling; unposed; wait; steps 1");
  prepared.run("click 30,30; ready; drag 30,30 60 -40");
  EXPECT_TRUE(same_bits(prepared.window.host(), at_once.window.host()));
}

TEST(DragSession, EachMoveShowsAPassingPoseOfTheNewestCursor) {
  Window window(hills());
  window.click(kMiddle);
  window.press(kMiddle);
  const Vector2 from = window.at(kMiddle).pixel;
  for (int i = 1; i <= 50; ++i) window.session.move(window.at(from + Vector2(i, 0)));
  window.session.wait();
  EXPECT_EQ(window.session.state(), State::Dragging);
  EXPECT_GE(window.poses(), 1);
  EXPECT_FALSE(window.settled());
  EXPECT_LT((window.view.pixel(window.host().row(kMiddle).transpose()) - (from + Vector2(50, 0))).norm(), 0.1);
  EXPECT_TRUE(same_bits(window.session.mesh().vertices, window.session.original().vertices));
}

TEST(DragSession, HandleIsTakenHoldOfByItsMarkThoughAFoldHidesIt) {
  play("set radius 6; drag 30,30 30 10; drag 30,30 10 30; steps 2; groups 30,30", hills());
}

TEST(DragSession, PressJustBesideTheEdgeMeansTheEdge) {
  play("press 59,59 2 -2; release 59,59 2 -2; wait; groups 59,59; clear; press 59,59 5 -5; groups none", hills());
}

TEST(DragSession, HandleOnTheFarSideIsNotInTheWay) {
  Window window(shapes::icosphere(4));
  int vertex = 0;
  for (const double side : {1.0, -1.0}) {
    window.view = support::view_from(Vector3(4 * side, 0, 0), Vector3::Zero());
    vertex = support::vertex_at(window.session.mesh(), side * Vector3::UnitX());
    window.click(vertex);
  }
  EXPECT_EQ(window.groups(), std::vector<std::vector<int>>{{vertex}});
}

TEST(DragSession, ClickShowsTheRegionAndMovesNothing) {
  play("click 30,30; state picked; groups 30,30; in 30,30 31,30; ready; same pose rest; logged 0; cannot undo",
       hills());
}

TEST(DragSession, ClickBesideTheMeshSaysSoAndDoesNothing) {
  play("press 0,0 -20 20; says 'no surface'; move 0,0 20 0; release 0,0 20 0; wait; state idle; out 0,0", hills());
}

TEST(DragSession, RefusesAMeshWithoutFaces) {
  TriangleMesh cloud;
  cloud.vertices = Points::Random(10, 3);
  cloud.faces.resize(0, 3);
  EXPECT_THROW(DragSession(cloud, StoredScalar::Float, {}), EditError);
}

TEST(DragSession, CancelledDragLeavesEveryBit) {
  play(
      "click 30,30; press 30,30; move 30,30 50 20; wait; other pose rest; cancel; same pose rest; settled; release "
      "30,30; wait; steps 0; drag 30,30 10 0; steps 1",
      hills());
}

TEST(DragSession, ReleasedStepCanBeDroppedUntilItIsThere) {
  play("press 30,30; move 30,30 50 20; release 30,30 50 20; state settling; cancel; steps 0; same pose rest", hills());
}

TEST(DragSession, FinishAppliesWhatWasReleasedAndDropsWhatIsHeld) {
  play("press 30,30; move 30,30 50 20; release 30,30 50 20; finish 3600; steps 1; consistent", hills());
  play("click 30,30; press 30,30; move 30,30 50 20; wait; finish 0; steps 0; same pose rest", hills());
}

TEST(DragSession, FinishDoesNotWaitLongerThanItMayAndTheStepFollows) {
  std::atomic<bool> held{false};  // the solver thread
  Window window(hills(), support::view_from_above(hills().vertices), [&held] {
    while (held) std::this_thread::yield();
  });
  held = true;
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(50, 20)));
  window.session.release(window.at(kMiddle, Vector2(50, 20)));
  EXPECT_FALSE(window.session.finish(std::chrono::milliseconds(1)));
  EXPECT_EQ(window.session.state(), State::Settling);
  EXPECT_TRUE(window.session.recorded().steps.empty());
  held = false;
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps.size(), 1U);
  EXPECT_TRUE(window.session.take_change()->settled);
}

TEST(DragSession, MouseWhileAStepIsWorkedOutIsNotLost) {
  play(
      "press 30,30; move 30,30 30 0; release 30,30 30 0; state settling; press 30,35; move 30,35 0 20; release 30,35 0 "
      "25; wait; steps 2",
      hills());
}

TEST(DragSession, NextClickAbandonsWhatIsPrepared) {
  play("press 30,30; release 30,30; click 10,10; groups 10,10; ready; in 10,10; anchor 10,10 not", hills());
}

TEST(DragSession, TypedAmountsAreExact) {
  play(
      "click 30,30; keys tx1.5; enter; recorded 0 translation 1.5 0 0; keys ty-2; enter; recorded 1 translation 0 -2 "
      "0; keys tz0.125; enter; recorded 2 translation 0 0 0.125; keys txy3; enter; recorded 3 translation 0 3 0; set "
      "radius 9; keys "
      "tz7864%; enter; recorded 4 translation 0 0 707.76",
      hills());
}

TEST(DragSession, NormalLockFollowsTheSurface) {
  Window window(shapes::icosphere(4), support::view_from(Vector3(4, 1, 2), Vector3::Zero()));
  const int vertex = support::vertex_at(window.session.mesh(), Vector3(4, 1, 2).normalized());
  window.click(vertex);
  window.keys("tn0.5\r");
  const Vector3 way = window.recorded().transform.translation;
  EXPECT_NEAR(way.norm(), 0.5, 1e-12);
  EXPECT_LT(std::acos(way.normalized().dot(window.session.original().vertices.row(vertex).normalized())), 0.02);
}

TEST(DragSession, TurnAndScaleGoAboutTheGroupsCenter) {
  support::Play played(hills());
  Window& window = played.run("set radius 12 disc 0.25; click 30,30; keys rz30; enter; keys s1.5; enter; steps 2");
  const HandleGroup turned = window.recorded(0);
  EXPECT_GT(turned.vertices.size(), 5U);
  EXPECT_EQ(turned.transform.degrees, 30);
  EXPECT_EQ(turned.transform.axis, Vector3::UnitZ());
  EXPECT_FALSE(turned.transform.center);
  EXPECT_EQ(window.recorded(1).transform.scale, 1.5);
  // Turned and grown for real: the handle's vertices span 1.5 times what they did.
  const auto spread = [&](const Points& all) {
    const Points points = support::rows(all, turned.vertices);
    return (points.rowwise() - points.colwise().mean()).norm();
  };
  EXPECT_NEAR(spread(window.host()) / spread(window.session.original().vertices), 1.5, 0.03);
}

TEST(DragSession, RotatingOrScalingASingleVertexIsRefused) {
  play(
      "click 30,30; keys r; state picked; says 'Turning needs a handle of several vertices, and this one is vertex "
      "1830 alone'; keys s; state picked; says 'Scaling needs a handle of several vertices, and this one is vertex "
      "1830 alone'",
      hills());
}

TEST(DragSession, KeyMotionFollowsTheMouseAndAClickAppliesIt) {
  Window window(hills());
  window.click(kMiddle);
  const Cursor start = window.at(Vector2(400, 300)), end = window.at(Vector2(425, 300));
  window.session.key(DragKey::Translate, start);
  window.session.move(end);
  EXPECT_EQ(window.session.state(), State::Dragging);
  window.session.press(end);
  window.session.release(end);
  window.session.wait();
  EXPECT_NEAR(window.recorded().transform.translation.x(), 25 * window.view.pixel_size(Vector3(30, 30, 0)), 1e-9);
}

}  // namespace
}  // namespace lapedit::drag_session_test
