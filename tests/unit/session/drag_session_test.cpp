// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
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
  const std::vector<int>& region = window.session.shown().region()->mesh_vertex;
  int fixed = 0;
  for (int v = 0; v < window.host().rows(); ++v) {
    if (!contains(region, v)) {
      ++fixed;
      EXPECT_EQ(window.host().row(v), window.session.original().vertices.row(v));
    }
  }
  EXPECT_GT(fixed, 100);
}

TEST(DragSession, ReleaseBeforeTheRegionIsReadyGivesTheSameBits) {
  Window prepared(hills());
  prepared.click(kMiddle);
  EXPECT_TRUE(prepared.session.preparation().ready);
  prepared.drag(kMiddle, Vector2(60, -40));
  Window at_once(hills());
  at_once.press(kMiddle);
  at_once.session.move(at_once.at(at_once.at(kMiddle).pixel + Vector2(60, -40)));
  at_once.session.release(at_once.at(at_once.at(kMiddle).pixel + Vector2(60, -40)));
  EXPECT_EQ(at_once.session.state(), State::Settling);
  EXPECT_EQ(at_once.poses(), 0);
  at_once.session.wait();
  EXPECT_EQ(at_once.session.recorded().steps.size(), 1U);
  EXPECT_TRUE(same_bits(prepared.host(), at_once.host()));
}

TEST(DragSession, EachMoveShowsAPassingPoseOfTheNewestCursor) {
  Window window(hills());
  window.click(kMiddle);
  window.press(kMiddle);
  const Vector2 from = window.at(kMiddle).pixel;
  for (int i = 1; i <= 50; ++i) {
    window.session.move(window.at(from + Vector2(i, 0)));
  }
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
  Window window(shapes::icosphere(4), support::view_from(Vector3(4, 0, 0), Vector3::Zero()));
  const int front = support::vertex_at(window.session.mesh(), Vector3::UnitX());
  window.click(front);
  window.view = support::view_from(Vector3(-4, 0, 0), Vector3::Zero());
  const int back = support::vertex_at(window.session.mesh(), -Vector3::UnitX());
  window.click(back);
  EXPECT_EQ(window.session.selection().groups, std::vector<std::vector<int>>{{back}});
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
  const TriangleMesh mesh = hills();
  std::atomic<bool> held{false};
  DragSession session(support::stored(mesh), StoredScalar::Float, {{}, [&held] {
                                                                     while (held) {  // the solver thread
                                                                       std::this_thread::yield();
                                                                     }
                                                                   }});
  const Camera view = support::view_from_above(mesh.vertices);
  const Vector2 from = view.pixel(mesh.vertices.row(kMiddle).transpose());
  session.searching();
  session.wait();
  DragSettings settings = session.settings();
  settings.first_radius = 0;
  session.set_settings(settings);
  held = true;
  session.press({view, from});
  session.move({view, from + Vector2(50, 20)});
  session.release({view, from + Vector2(50, 20)});
  EXPECT_FALSE(session.finish(std::chrono::milliseconds(1)));
  EXPECT_EQ(session.state(), State::Settling);
  EXPECT_TRUE(session.recorded().steps.empty());
  held = false;
  session.wait();
  EXPECT_EQ(session.recorded().steps.size(), 1U);
  EXPECT_TRUE(session.take_change()->settled);
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
  const Vector3 way = window.session.recorded().steps.at(0).handles[0].transform.translation;
  EXPECT_NEAR(way.norm(), 0.5, 1e-12);
  EXPECT_LT(std::acos(way.normalized().dot(window.session.original().vertices.row(vertex).normalized())), 0.02);
}

TEST(DragSession, TurnAndScaleGoAboutTheGroupsCenter) {
  Window window(hills());
  window.change([](DragSettings& s) { s.handle_fraction = 3 / s.radius; });
  window.click(kMiddle);
  EXPECT_GT(window.session.selection().groups.at(0).size(), 5U);
  window.keys("rz30\r");
  window.keys("s1.5\r");
  const Edit edit = window.session.recorded();
  ASSERT_EQ(edit.steps.size(), 2U);
  EXPECT_EQ(edit.steps[0].handles[0].transform.degrees, 30);
  EXPECT_EQ(edit.steps[0].handles[0].transform.axis, Vector3::UnitZ());
  EXPECT_FALSE(edit.steps[0].handles[0].transform.center);
  EXPECT_EQ(edit.steps[1].handles[0].transform.scale, 1.5);
  window.expect_consistent();
  // Turned and grown for real: the handle's vertices span 1.5 times what they did.
  const Points before = support::rows(window.session.original().vertices, edit.steps[0].handles[0].vertices);
  const Points after = support::rows(window.host(), edit.steps[0].handles[0].vertices);
  const auto spread = [](const Points& points) { return (points.rowwise() - points.colwise().mean()).norm(); };
  EXPECT_NEAR(spread(after) / spread(before), 1.5, 0.03);
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
  const Vector2 start(400, 300);
  window.session.key(DragKey::Translate, window.at(start));
  window.session.move(window.at(start + Vector2(25, 0)));
  EXPECT_EQ(window.session.state(), State::Dragging);
  window.session.press(window.at(start + Vector2(25, 0)));
  window.session.release(window.at(start + Vector2(25, 0)));
  window.session.wait();
  const Vector3 way = window.session.recorded().steps.at(0).handles[0].transform.translation;
  EXPECT_NEAR(way.x(), 25 * window.view.pixel_size(Vector3(30, 30, 0)), 1e-9);
}

}  // namespace
}  // namespace lapedit::drag_session_test
