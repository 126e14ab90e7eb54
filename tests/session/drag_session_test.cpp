// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/drag_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "drag_support.h"

namespace lapedit::drag_session_test {
namespace {

using support::same_bits;
using support::Window;
using State = DragSession::State;

constexpr int kMiddle = 30 * 60 + 30;  // of a grid of 60 x 60

TriangleMesh hills() {
  TriangleMesh mesh = shapes::grid(60, 60);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    const Vector3 p = mesh.vertices.row(v).transpose();
    mesh.vertices(v, 2) = std::sin(0.9 * p.x()) * std::cos(0.7 * p.y());
  }
  return mesh;
}

bool has(const std::vector<int>& set, int vertex) {
  return std::find(set.begin(), set.end(), vertex) != set.end();
}

// --- The simplest gesture -------------------------------------------------------------------------------------------

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
    if (!has(region, v)) {
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
  Window window(hills());
  window.change([](DragSettings& s) { s.radius = 6; });
  window.drag(kMiddle, Vector2(30, 10));  // sideways: the sheet folds over
  window.drag(kMiddle, Vector2(10, 30));
  EXPECT_EQ(window.session.recorded().steps.size(), 2U);
  EXPECT_EQ(window.session.selection().groups, std::vector<std::vector<int>>{{kMiddle}});
}

TEST(DragSession, PressJustBesideTheEdgeMeansTheEdge) {
  Window window(hills());
  const int corner = 59 * 60 + 59;
  window.session.press(window.at(corner, Vector2(2, -2)));
  window.session.release(window.at(corner, Vector2(2, -2)));
  window.session.wait();
  EXPECT_EQ(window.session.selection().groups, std::vector<std::vector<int>>{{corner}});
  window.session.clear();
  window.session.press(window.at(corner, Vector2(5, -5)));
  EXPECT_TRUE(window.session.selection().groups.empty());
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
  Window window(hills());
  window.click(kMiddle);
  EXPECT_EQ(window.session.state(), State::Picked);
  ASSERT_NE(window.session.shown().region(), nullptr);
  EXPECT_EQ(window.session.shown().region()->count(VertexClass::Handle), 1);
  EXPECT_GT(window.session.shown().region()->count(VertexClass::Anchor), 0);
  EXPECT_EQ(window.poses(), 0);
  EXPECT_TRUE(window.log.empty());
  EXPECT_FALSE(window.session.can_undo());
}

TEST(DragSession, ClickBesideTheMeshSaysSoAndDoesNothing) {
  Window window(hills());
  window.session.press(window.at(Vector2(1, 1)));
  EXPECT_TRUE(window.says("no surface"));
  window.session.move(window.at(Vector2(100, 100)));
  window.session.release(window.at(Vector2(100, 100)));
  window.session.wait();
  EXPECT_EQ(window.session.state(), State::Idle);
  EXPECT_EQ(window.session.shown().region(), nullptr);
}

TEST(DragSession, RefusesAMeshWithoutFaces) {
  TriangleMesh cloud;
  cloud.vertices = Points::Random(10, 3);
  cloud.faces.resize(0, 3);
  EXPECT_THROW(DragSession(cloud, StoredScalar::Float, {}), EditError);
}

// --- Dropping -------------------------------------------------------------------------------------------------------

TEST(DragSession, CancelledDragLeavesEveryBit) {
  Window window(hills());
  window.click(kMiddle);
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(50, 20)));
  window.session.wait();
  EXPECT_FALSE(same_bits(window.host(), window.session.original().vertices));
  window.keys("\b");
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
  EXPECT_TRUE(window.settled());
  window.session.release(window.at(kMiddle));
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps.size(), 0U);
  window.drag(kMiddle, Vector2(10, 0));  // the region is still ready
  window.expect_consistent();
}

TEST(DragSession, ReleasedStepCanBeDroppedUntilItIsThere) {
  Window window(hills());
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(50, 20)));
  window.session.release(window.at(kMiddle, Vector2(50, 20)));
  window.session.cancel();
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps.size(), 0U);
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
}

TEST(DragSession, FinishAppliesWhatWasReleasedAndDropsWhatIsHeld) {
  Window released(hills());
  released.press(kMiddle);
  released.session.move(released.at(kMiddle, Vector2(50, 20)));
  released.session.release(released.at(kMiddle, Vector2(50, 20)));
  EXPECT_TRUE(released.session.finish(std::chrono::hours(1)));
  EXPECT_EQ(released.session.recorded().steps.size(), 1U);
  released.expect_consistent();

  Window held(hills());
  held.click(kMiddle);
  held.press(kMiddle);
  held.session.move(held.at(kMiddle, Vector2(50, 20)));
  held.session.wait();
  EXPECT_TRUE(held.session.finish({}));
  EXPECT_EQ(held.session.recorded().steps.size(), 0U);
  EXPECT_TRUE(same_bits(held.host(), held.session.original().vertices));
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
  Window window(hills());
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(30, 0)));
  window.session.release(window.at(kMiddle, Vector2(30, 0)));
  ASSERT_EQ(window.session.state(), State::Settling);
  const int other = kMiddle + 5;
  window.press(other);
  window.session.move(window.at(other, Vector2(0, 20)));
  window.session.release(window.at(other, Vector2(0, 25)));
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps.size(), 2U);
  window.expect_consistent();
}

TEST(DragSession, NextClickAbandonsWhatIsPrepared) {
  Window window(hills());
  window.press(kMiddle);
  window.session.release(window.at(kMiddle));
  EXPECT_TRUE(window.session.preparation().running);
  const int other = 10 * 60 + 10;
  window.click(other);
  EXPECT_EQ(window.session.selection().groups, std::vector<std::vector<int>>{{other}});
  EXPECT_TRUE(window.session.preparation().ready);
  EXPECT_EQ(window.session.shown().region()->classes[static_cast<std::size_t>(
                std::lower_bound(window.session.shown().region()->mesh_vertex.begin(),
                                 window.session.shown().region()->mesh_vertex.end(), other) -
                window.session.shown().region()->mesh_vertex.begin())],
            VertexClass::Handle);
}

// --- Keys -----------------------------------------------------------------------------------------------------------

TEST(DragSession, TypedAmountsAreExact) {
  const struct {
    const char* keys;
    Vector3 translation;
  } cases[] = {{"tx1.5\r", {1.5, 0, 0}}, {"ty-2\r", {0, -2, 0}}, {"tz0.125\r", {0, 0, 0.125}}, {"txy3\r", {0, 3, 0}}};
  for (const auto& c : cases) {
    Window window(hills());
    window.click(kMiddle);
    window.keys(c.keys);
    ASSERT_EQ(window.session.recorded().steps.size(), 1U) << c.keys;
    EXPECT_EQ(window.session.recorded().steps[0].handles[0].transform.translation, c.translation) << c.keys;
    window.expect_consistent();
  }
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

TEST(DragSession, LockedAxisKeepsTheOtherCoordinates) {
  Window window(hills());
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(10, 10)));
  window.session.key(DragKey::LockX, window.at(kMiddle, Vector2(10, 10)));
  window.session.move(window.at(kMiddle, Vector2(80, 55)));
  window.session.release(window.at(kMiddle, Vector2(80, 55)));
  window.session.wait();
  const Vector3 way = window.session.recorded().steps.at(0).handles[0].transform.translation;
  EXPECT_NEAR(way.x(), 80 * window.view.pixel_size(Vector3(30, 30, 0)), 1e-9);
  EXPECT_EQ(way.y(), 0);
  EXPECT_EQ(way.z(), 0);
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

/// Fails if the line over the picture does not say why frames are slow, or says it where they are not.
TEST(DragSession, SaysWhereFramesAreFullSolutions) {
  for (const EditMethod method : {EditMethod::Default, EditMethod::Paper}) {
    Window window(hills());
    window.change([method](DragSettings& s) { s.edit = EditSettings::of(method); });
    window.click(kMiddle);
    window.press(kMiddle);
    window.session.move(window.at(window.at(kMiddle).pixel + Vector2(20, 10)));
    EXPECT_EQ(window.says("each frame is a full solution"), method == EditMethod::Paper);
  }
}

TEST(DragSession, RotatingOrScalingASingleVertexIsRefused) {
  Window window(hills());
  window.click(kMiddle);
  for (const char* key : {"r", "s"}) {
    window.keys(key);
    EXPECT_EQ(window.session.state(), State::Picked);
    EXPECT_NE(window.session.message().find(std::string(*key == 'r' ? "Turning" : "Scaling") +
                                            " needs a handle of several vertices, and this one is vertex " +
                                            std::to_string(kMiddle) + " alone"),
              std::string::npos);
  }
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

// --- On the drag path -----------------------------------------------------------------------------------------------

TEST(DragSession, AnyEventsLeaveAConsistentSession) {
  Window window(shapes::letter_field(40, 20));
  std::mt19937 random(20260);
  const auto pick = [&random](int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); };
  const int n = static_cast<int>(window.host().rows());
  Edit saved;
  const std::string keys = "xyzntrsgcwpbv0123456789.-\r\b";
  for (int event = 0; event < 3000; ++event) {
    DragSession& session = window.session;
    Cursor cursor =
        pick(8) == 0 ? window.at(Vector2(pick(800), pick(600))) : window.at(pick(n), Vector2(pick(9) - 4, pick(9) - 4));
    cursor.snap = pick(4) == 0;
    switch (pick(27)) {
      case 0:
      case 1:
      case 2:
        session.hover(cursor, {pick(6) == 0, pick(6) == 0});
        session.press(cursor, {pick(6) == 0, pick(6) == 0});
        break;
      case 3:
      case 4:
      case 5:
      case 6:
        session.move(cursor);
        break;
      case 7:
      case 8:
      case 9:
        session.release(cursor);
        break;
      case 10:
      case 11:
        session.key(support::key_of(keys[static_cast<std::size_t>(pick(static_cast<int>(keys.size())))]), cursor);
        break;
      case 12: {
        DragSettings settings = session.settings();
        settings.radius = 0.05 * (1 + pick(12));
        settings.padding = 0.1 * pick(12);  // 1.1 is refused
        settings.handle_fraction = 0.3 * pick(4);
        settings.edit.order = 1 + pick(2);  // 2 is refused
        settings.edit.iterations = 1 + pick(2);
        settings.falloff = static_cast<Falloff>(pick(4));
        session.set_settings(settings);
        break;
      }
      case 20:
        session.set(&Tools::paint, pick(3) ? std::optional(static_cast<BrushTarget>(pick(3))) : std::nullopt);
        pick(2) ? session.change_painted(static_cast<PaintChange>(pick(3))) : session.set_handle({pick(n), pick(n)});
        break;
      case 21:
        session.set(&Tools::gizmo, pick(4) != 0);
        session.set(&Tools::axes, static_cast<GizmoAxes>(pick(3)));
        session.set(&Tools::pivot, static_cast<Pivot>(pick(3)));
        break;
      case 24:
        session.set(&Tools::mirror,
                    pick(2) ? std::optional(MirrorPlane{Vector3(2, 1, 0), Vector3::Unit(pick(3))}) : std::nullopt);
        break;
      case 22:
        session.set_anchors({pick(n), pick(n), pick(n)});
        break;
      case 23:
        session.cancel();
        session.leave();
        break;
      case 13:
        session.undo();
        break;
      case 14:
        session.redo();
        break;
      case 15:
        pick(2) ? session.key(DragKey::Grow) : session.key(DragKey::Shrink);
        break;
      case 16:
        pick(2) ? session.whole_component() : session.clear();
        break;
      case 17:
        session.set_region({pick(n), pick(n), pick(n)});
        break;
      case 18:
        if (pick(3) == 0) {
          saved = session.recorded();
        } else if (!saved.steps.empty() && saved.steps.size() < 4 && pick(4) == 0) {
          session.load(saved);
        }
        break;
      case 19:
        if (pick(8) == 0) {
          session.finish({});
        }
        session.wait();
        ASSERT_FALSE(session.busy()) << "event " << event;
        ASSERT_NE(session.state(), State::Settling) << "event " << event;
        break;
      default:
        session.poll();
    }
    ASSERT_TRUE(window.host().allFinite()) << "event " << event;
    ASSERT_FALSE(session.message().empty());
    if (event % 100 == 99) {
      session.finish({});
      session.wait();
      ASSERT_TRUE(same_bits(window.host(), session.mesh().vertices)) << "event " << event;
    }
    if (session.figures().steps > 12) {
      session.finish({});
      session.wait();
      window.expect_consistent();
      session.go_to(0);
      ASSERT_TRUE(same_bits(window.host(), session.original().vertices)) << "event " << event;
    }
  }
  window.session.finish({});
  window.session.wait();
  window.expect_consistent();
  window.session.go_to(0);
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
}

}  // namespace
}  // namespace lapedit::drag_session_test
