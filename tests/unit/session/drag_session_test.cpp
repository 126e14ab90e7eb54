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

using support::hills;
using support::kMiddle;
using support::play;
using support::same_bits;
using support::Window;
using State = DragSession::State;

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

TEST(DragSession, RefusesAMeshWithoutFaces) {
  TriangleMesh cloud;
  cloud.vertices = Points::Random(10, 3);
  cloud.faces.resize(0, 3);
  EXPECT_THROW(DragSession(cloud, StoredScalar::Float, {}), EditError);
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
