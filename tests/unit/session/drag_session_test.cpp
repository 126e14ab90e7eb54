// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <thread>

#include "bodies.h"
#include "lapedit/edit/fit_step.h"
#include "lapedit/mesh/vertex_tree.h"
#include "play.h"

// Regions, handles and steps of a dragging session, the detail of a region, and torn meshes.
namespace lapedit::drag_session_test {
namespace {

using support::at;
using support::hills;
using support::kMiddle;
using support::plate;
using support::Play;
using support::play;
using support::same_bits;
using support::Window;
using State = DragSession::State;

/// A session with the settings of a newcomer: a press takes the radius of what stands out there.
class DragPress : public testing::Test {
 protected:
  const TriangleMesh mesh = support::stored(plate());
  const Camera view = support::view_from_above(mesh.vertices);
  const Cursor cursor{view, view.pixel(mesh.vertices.row(kMiddle).transpose())};
  DragSession session{mesh, StoredScalar::Float, {}};
};

TEST_F(DragPress, WaitsForNothingBeforeTheSurfaceCanBeSearched) {
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

TEST_F(DragPress, IsForgottenByEscBeforeItsRadiusIsKnown) {
  session.searching();
  session.wait();
  EXPECT_TRUE(session.press(cursor));
  EXPECT_TRUE(session.key(DragKey::Cancel));
  session.move({view, cursor.pixel + Vector2(20, 0)});
  session.release({view, cursor.pixel + Vector2(20, 0)});
  session.wait();
  EXPECT_TRUE(session.selection().groups.empty());
}

TEST_F(DragPress, AfterAStepIsHandledOnceTheNewPoseCanBeSearched) {
  Window window(plate());
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(20, 10)));
  window.session.release(window.at(kMiddle, Vector2(20, 10)));
  while (window.session.figures().steps == 0) window.session.poll();
  EXPECT_FALSE(window.session.press(window.at(Vector2(1, 1)))) << "off the mesh";
  window.click(at(50, 50));
  EXPECT_EQ(window.groups(), (std::vector<std::vector<int>>{{at(50, 50)}}));
  window.expect_consistent();
}

TEST(DragHandle, CurveStaysOnItsPiece) {
  play("mode curve; click 30,30; click 60,12; says 'No path along edges'; groups 30,30",
       shapes::together(shapes::grid(60, 60), shapes::grid(5, 5), Vector3(70, 0, 0)));
}

/// Three groups in a row, the middle one chosen last.
constexpr const char* kThree = "set radius 14; click 26,30; keys g; click 34,30; keys g; click 30,34; count 3;";

TEST(DragHandles, ShiftClickChoosesGroupsThatMoveTogether) {
  play(kThree +
       std::string("click 26,30 take; moving 0 2; count 3; says '2 of 3 move together'; drag 30,34 20 25; together "
                   "26,30 30,34; rests 34,30 30,34 0.01; consistent; undo; moving 0 2; drag 34,30 0 20; moving 1"));
}

TEST(DragHandles, ChosenGroupsRotateAboutTheirCommonCentre) {
  Play played;
  Window& window = played.run(kThree + std::string("click 26,30 take; click 34,30 take; click 30,34 take; moving 0 1; "
                                                   "keys rz90; enter; recorded 0 degrees 90 90 0"));
  const EditStep step = window.session.recorded().steps.at(0);
  ASSERT_TRUE(step.handles[0].transform.center);
  const Points rest = support::rows(window.session.original().vertices, {at(26, 30), at(34, 30)});
  const Vector3 middle = rest.colwise().mean().transpose();
  EXPECT_LT((*step.handles[0].transform.center - middle).norm(), 1e-9);
  EXPECT_EQ(step.handles[1].transform.center, step.handles[0].transform.center);
  const Vector3 before = rest.row(0).transpose() - middle;
  const Vector3 after = window.host().row(at(26, 30)).transpose() - middle;
  EXPECT_LT((after - Vector3(-before.y(), before.x(), before.z())).norm(), 0.05);
}

/// A curve through three points, 5 vertices apart.
constexpr const char* kMouth = "set radius 15; mode curve; click 25,30; click 30,30; click 35,30; count 1; points 3;";

TEST(DragCurve, BendsByAPointWhileTheOthersHold) {
  Play played;
  Window& window = played.run(std::string(kMouth) + "drag 35,30 0 -30; recorded 0 targets 11");
  const Points rest = window.session.original().vertices;
  const HandleGroup handle = window.recorded();
  std::vector<double> up;
  for (int i = 25; i <= 35; ++i) {
    up.push_back((handle.targets[index_in(handle.vertices, at(i, 30))] - rest.row(at(i, 30)).transpose()).y());
  }
  for (int i = 0; i <= 5; ++i) EXPECT_EQ(up[i], 0) << i;
  for (int i = 6; i <= 10; ++i) {
    EXPECT_GT(up[i] - up[i - 1], i > 6 ? up[i - 1] - up[i - 2] : 0) << i;  // turns up more and more towards its end
  }
  const auto way = [&](int i) { return window.host()(at(i, 30), 1) - rest(at(i, 30), 1); };
  EXPECT_NEAR(way(35), up[10], 0.02 * up[10]);
  // The curve still bends, by another point: a smile.
  played.run("drag 25,30 0 -30; recorded 1 targets 11");
  EXPECT_GT(way(25), 0.9 * up[10]);
  EXPECT_LT(std::abs(way(30)), 0.02 * up[10]);
  // Solved again with other settings, and taken back with its points.
  played.run("set membrane 100; consistent; undo 2; same pose rest; points 3");
}

TEST(DragCurve, ClosedOneBendsOnBothSidesOfItsFirstPoint) {
  HandleCurve square;
  square.path = {at(20, 20), at(21, 20), at(22, 20), at(22, 21), at(22, 22),
                 at(21, 22), at(20, 22), at(20, 21), at(20, 20)};
  square.points = {0, 2, 4, 6, 8};
  const std::vector<int> group = sorted_set(square.path);
  for (const int point : {0, 4}) {
    const std::vector<double> weights = bend_weights(shapes::grid(60, 60), group, square, point);
    EXPECT_GT(weights[index_in(group, at(21, 20))], 0.4);
    EXPECT_NEAR(weights[index_in(group, at(20, 21))], weights[index_in(group, at(21, 20))], 1e-12);
  }
}

/// Bent by keys, the amount is the point's.
TEST(DragCurve, PressBetweenItsPointsMovesAllOfIt) {
  play(std::string(kMouth) +
       "drag 33,30 0 -30; recorded 0 targets 0; press 35,30; move 35,30 0 -10; keys y2; enter; recorded 1 targets 11");
}

TEST(DragCurve, NextPieceIsShownAsTheClickTakesIt) {
  Play played;
  Window& window = played.run("set radius 15; mode curve; click 25,30");
  ASSERT_TRUE(window.hovered(window.at(at(31, 33))));
  const Points shown = window.session.hover()->path;
  window.click(at(31, 33));
  const std::vector<int>& path = window.session.selection().discs.curves[0].path;
  EXPECT_EQ(shown, support::rows(window.session.mesh().vertices, path));
  ASSERT_TRUE(window.hovered(window.at(at(31, 33))));
  ASSERT_TRUE(window.session.hover()->curve_point);
  EXPECT_EQ(window.session.hover()->path.rows(), 0);
}

TEST(DragSteps, GoingBackPreparesOnceHoweverManyStepsItUndoes) {
  Window window(plate());
  for (const int x : {10, 20, -30}) window.drag(kMiddle, Vector2(x, 5));
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
  for (const int steps : {0, 3}) {
    EXPECT_EQ(prepared([&] { window.session.go_to(steps); }), one);
    EXPECT_TRUE(same_bits(window.host(), steps ? edited : window.session.original().vertices));
  }
  window.expect_consistent();
}

TEST(DragSteps, SavedEditLoadsToTheSameBits) {
  Play played;
  Window& window = played.run("set radius 3; drag 15,15 40 25; drag 45,45 10 -25");  // in two regions
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
  EXPECT_EQ(window.session.selection().active, static_cast<int>(window.groups().size()) - 1);
  window.drag(nearest_vertex(mesh, Vector3(0, 1.3, 0)), Vector2(10, 30));
  window.expect_consistent();
  EXPECT_EQ(window.session.recorded().steps.at(0).fit->to, "scan");
  window.undo(1);
  EXPECT_TRUE(same_bits(window.host(), fitted));
  window.undo(1);
  EXPECT_TRUE(same_bits(window.host(), mesh.vertices));
}

TEST(DragSteps, AreSavedAndPaintedVerticesStayAfterOtherCodeChangedTheMesh) {
  Play played;
  const DragSession& before =
      played.run("click 30,30; keep a; region 26,26 34,34; anchors 26,30 2,2; set radius 3; drag 30,30 10 5").session;
  const auto inherited = [](const DragSession& old, const TriangleMesh& mesh) {
    auto next = std::make_unique<Window>(mesh);
    next->session.inherit(old.inheritance());
    return next;
  };
  TriangleMesh smoothed = before.mesh();
  smoothed.vertices.col(2) *= 0.5;
  const auto after = inherited(before, smoothed);
  EXPECT_TRUE(after->says("1 step cannot be undone"));
  EXPECT_EQ(after->session.settings().radius, 3);
  EXPECT_FALSE(after->session.can_undo());
  EXPECT_TRUE(after->session.selection().by_hand);
  EXPECT_TRUE(contains(after->session.selection().held, at(2, 2)));
  EXPECT_EQ(after->region(), played.window.region());
  EXPECT_EQ(after->session.saved().steps.size(), 1U);
  // Another change without steps in between loses nothing more.
  const auto third = inherited(after->session, smoothed);
  EXPECT_EQ(third->session.saved().steps.size(), 1U);
  third->drag(kMiddle, Vector2(5, 5));
  EXPECT_EQ(third->session.saved().steps.at(0).region.held, third->session.selection().held);
  third->expect_consistent();
  third->undo();
  EXPECT_TRUE(third->session.can_save());
  const auto other = inherited(before, shapes::grid(9, 9));
  EXPECT_TRUE(other->session.selection().held.empty());
  EXPECT_FALSE(other->session.selection().has_region);
  EXPECT_TRUE(other->session.can_save());
}

TEST(DragSteps, EditOfAnotherMeshIsRefused) {
  Play played;
  Window other(shapes::grid(20, 20));
  other.session.load(played.run("drag 30,30 40 25").session.recorded());
  other.session.wait();
  EXPECT_EQ(other.session.state(), State::Idle);
  EXPECT_TRUE(other.says("made for a mesh of 3600 vertices"));
  EXPECT_TRUE(same_bits(other.host(), other.session.original().vertices));
}

TEST(DragSteps, FiguresTellOfTheLastStep) {
  Window window(plate());
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(60, 0)));
  window.session.wait();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!window.session.figures().report && std::chrono::steady_clock::now() < deadline) {
    window.session.poll();  // the report is made when the mouse pauses
  }
  const DragFigures figures = window.session.figures();
  ASSERT_TRUE(figures.report);
  EXPECT_GT(figures.report->stretch_max, 0.01);
  EXPECT_GT(figures.report->handle_residual, 0);
  EXPECT_LT(figures.report->handle_residual, 0.1);
  EXPECT_EQ(figures.handle, 1);
  EXPECT_EQ(figures.handle + figures.free + figures.anchors + figures.fixed, 3600);
  // The next region is ready, and what was released is still told of.
  window.session.release(window.at(kMiddle, Vector2(90, 0)));
  window.session.wait();
  EXPECT_GT(window.session.figures().report->stretch_max, figures.report->stretch_max);
  // Of another handle nothing is known before it is moved.
  window.click(kMiddle + 3);
  EXPECT_FALSE(window.session.figures().report);
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
  EXPECT_EQ(window.session.figures().advice(), "");
  window.session.undo();
  window.drag(kMiddle, Vector2(250, 10));
  const std::string advice = window.session.figures().advice();
  EXPECT_NE(advice.find("folded over near vertex"), std::string::npos);
  EXPECT_EQ(window.log.back().substr(window.log.back().size() - advice.size() - 2), "; " + advice);
  Window other(plate());
  other.session.load(window.session.recorded());
  other.session.wait();
  ASSERT_EQ(other.log.size(), 2U);
  EXPECT_EQ(other.log.back(), "step 1 of the saved edit: " + advice);
}

TEST(DragLastStep, OfABentCurveAndOfSeveralHandlesAndOnBothSides) {
  Play bent;
  Window& window = bent.run(std::string(kMouth) + "drag 35,30 0 -30");
  ASSERT_TRUE(window.session.last_step() && window.session.last_step()->bent);
  const auto way = [&] { return window.host()(at(35, 30), 1) - window.session.original().vertices(at(35, 30), 1); };
  const double whole = way();
  bent.run("last 0 0 0 0.5; consistent");
  EXPECT_NEAR(way(), whole / 2, 0.02 * whole);

  play(kThree + std::string("click 26,30 take; keys rz90; enter; last 0 0 0 0.5; recorded 0 degrees 45 0 45"));

  play("mirror 29.5; click 38,30; keys tz4; enter; last 0 0 4 0.5; moved 38,30 0 0 2 0.05; moved 21,30 0 0 2 0.05",
       shapes::grid(60, 60));
}

TEST(DragLastStep, RefusesWhatItCannotDo) {
  Play played;
  DragSession& session = played.run("click 30,30; keys tz4; enter; keep a; last 0 0 4 1.5; says 'from 0 to 1'").session;
  HandleTransform motion = session.last_step()->motion;
  EXPECT_TRUE(session.last_step()->single);
  motion.degrees = 10;
  session.set_last_step(motion, 1);
  played.run("says 'Turning needs a handle of several vertices'");
  motion = HandleTransform();
  motion.scale = 0;
  session.set_last_step(motion, 1);
  played.run("says 'greater than 0'; same pose a");
}

/// Positions that no arithmetic would give back: negative zeros, denormals, numbers without a short decimal.
Points positions(int rows, int seed) {
  Points result(rows, 3);
  for (int i = 0; i < rows; ++i) {
    result.row(i) << -0.0, std::numeric_limits<double>::denorm_min() * (i + seed), 1.0 / (3 + i + 7 * seed);
  }
  return result;
}

TEST(History, MeshGivenToOthersNeverChangesAndStepsAreUndoneToTheBit) {
  History history(shapes::grid(40, 40));
  for (int k = 1; k < 9; ++k) {
    const std::shared_ptr<const TriangleMesh> given = k % 2 ? history.mesh() : nullptr;
    const Points before = history.current().vertices;
    history.apply({}, {k, k + 1, 100 * (k % 7) + 20}, positions(3, k));
    const Points after = history.current().vertices;
    EXPECT_TRUE(same_bits(history.before_last()->vertices, before)) << k;
    history.undo();
    EXPECT_TRUE(same_bits(history.current().vertices, before)) << k;
    history.redo();
    EXPECT_TRUE(same_bits(history.current().vertices, after)) << k;
    EXPECT_TRUE(!given || same_bits(given->vertices, before)) << k;
  }
}

TEST(DragSession, ReleaseMovesTheRegionAlone) {
  support::Play played(hills());
  Window& window = played.run("drag 30,30 60 -40; state picked; steps 1; under 30,30 60 -40; settled; consistent");
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
