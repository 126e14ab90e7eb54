// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "drag_support.h"
#include "lapedit/session/drag_session.h"

// Regions, handles and steps of a dragging session.
namespace lapedit {
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

int at(int i, int j) {
  return 60 * i + j;
}

const int kMiddle = at(30, 30);

template <class Change>
void change(Window& window, const Change& changed) {
  DragSettings settings = window.session.settings();
  changed(settings);
  window.session.set_settings(settings);
  window.session.wait();
}

const std::vector<int>& region_of(const Window& window) {
  return window.session.region()->mesh_vertex;
}

bool has(const std::vector<int>& set, int vertex) {
  return std::binary_search(set.begin(), set.end(), vertex);
}

// --- Regions --------------------------------------------------------------------------------------------------------

TEST(DragRegion, RadiusAndPaddingChangeItLive) {
  Window window(plate());
  window.click(kMiddle);
  change(window, [](DragSettings& s) { s.radius = 5; });
  const std::size_t small = region_of(window).size();
  const int anchors = window.session.region()->count(VertexClass::Anchor);
  change(window, [](DragSettings& s) { s.padding = 0.4; });
  EXPECT_EQ(region_of(window).size(), small);
  EXPECT_GT(window.session.region()->count(VertexClass::Anchor), anchors);
  change(window, [](DragSettings& s) { s.radius = 10; });
  EXPECT_GT(region_of(window).size(), 3 * small);
  EXPECT_EQ(window.session.figures().steps, 0);
}

TEST(DragRegion, SettingsOutOfRangeAreRefusedAndChangeNothing) {
  Window window(plate());
  window.click(kMiddle);
  const double radius = window.session.settings().radius;
  change(window, [](DragSettings& s) { s.radius = -1; });
  EXPECT_NE(window.session.message().find("radius"), std::string::npos);
  EXPECT_EQ(window.session.settings().radius, radius);
  change(window, [](DragSettings& s) { s.edit.order = 4; });
  EXPECT_EQ(window.session.settings().edit.order, 1);
  EXPECT_TRUE(window.session.ready());
}

TEST(DragRegion, AnotherHandleInsideKeepsItOneOutsideDoesNot) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 8; });
  window.click(kMiddle);
  const std::vector<int> before = region_of(window);
  window.click(at(33, 31));
  EXPECT_EQ(region_of(window), before);
  EXPECT_EQ(window.session.groups(), (std::vector<std::vector<int>>{{at(33, 31)}}));
  window.drag(at(33, 31), Vector2(30, 10));
  window.drag(at(29, 30), Vector2(0, 20));
  EXPECT_EQ(region_of(window), before);
  window.click(at(50, 50));
  EXPECT_NE(region_of(window), before);
  EXPECT_TRUE(has(region_of(window), at(50, 50)));
  window.expect_consistent();
}

/// The paper's loop: anchors are settled with the first handle, so that the factor serves all others.
TEST(DragRegion, AnotherHandleFindsTheAnchorsAsTheyWere) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 8; });
  window.click(kMiddle);
  const KeptAnchors first = anchors_of(*window.session.region());
  ASSERT_FALSE(first.empty());
  const auto expect_the_same = [&] {
    const KeptAnchors now = anchors_of(*window.session.region());
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
  window.session.undo();
  window.session.wait();
  window.session.redo();
  window.session.wait();
  expect_the_same();
  window.expect_consistent();
  // Another padding is another band.
  change(window, [](DragSettings& s) { s.padding = 0.3; });
  EXPECT_GT(anchors_of(*window.session.region()).vertices.size(), first.vertices.size());
  window.expect_consistent();
}

TEST(DragRegion, NewRegionCanBeAskedForInsideTheOldOne) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 8; });
  window.click(kMiddle);
  const std::vector<int> before = region_of(window);
  window.session.new_region();
  window.click(at(33, 31));
  EXPECT_NE(region_of(window), before);
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
  ASSERT_NE(window.session.region(), nullptr);
  EXPECT_EQ(region_of(window), set);
  EXPECT_EQ(window.session.state(), State::Idle);
  window.click(at(50, 50));
  EXPECT_NE(window.session.message().find("outside the region"), std::string::npos);
  EXPECT_EQ(region_of(window), set);
  window.drag(at(50, 50), Vector2(40, 0));
  EXPECT_EQ(window.session.figures().steps, 0);
  window.drag(kMiddle, Vector2(25, 0));
  EXPECT_EQ(region_of(window), set);
  EXPECT_EQ(window.session.figures().steps, 1);
  window.expect_consistent();
}

TEST(DragRegion, BrushAddsAndTakesWhatIsUnderIt) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 5; });
  window.click(kMiddle);
  const std::vector<int> before = region_of(window);
  ASSERT_FALSE(has(before, at(45, 30)));
  const Vector2 to_the_right = window.at(at(45, 30)).pixel - window.at(kMiddle).pixel;
  window.drag(kMiddle, to_the_right, kAdd);
  const std::vector<int> larger = region_of(window);
  EXPECT_TRUE(has(larger, at(45, 30)));
  EXPECT_TRUE(std::includes(larger.begin(), larger.end(), before.begin(), before.end()));
  EXPECT_EQ(window.session.groups(), (std::vector<std::vector<int>>{{kMiddle}}));
  window.drag(at(45, 30), Vector2(3, 3), kTake);
  EXPECT_FALSE(has(region_of(window), at(45, 30)));
  EXPECT_TRUE(has(region_of(window), kMiddle));
  // The handle is not brushed away.
  window.drag(kMiddle, Vector2(5, 5), kTake);
  EXPECT_TRUE(has(region_of(window), kMiddle));
  EXPECT_EQ(window.session.figures().steps, 0);
  EXPECT_EQ(window.poses(), 0);
}

TEST(DragRegion, KeysEndAStroke) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 5; });
  window.click(kMiddle);
  window.press(at(33, 30), kAdd);
  window.session.move(window.at(at(40, 30)));
  window.keys("tx5");
  window.session.move(window.at(at(45, 30)));
  EXPECT_EQ(window.session.state(), State::Dragging);
  const std::vector<int> region = region_of(window);
  window.session.release(window.at(at(45, 30)));
  window.keys("\r");
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_EQ(region_of(window), region);
  EXPECT_TRUE(has(region, at(40, 30)));
  EXPECT_EQ(window.session.figures().steps, 1);
  window.expect_consistent();
}

TEST(DragRegion, BrushDoesNotTouchTheFarSide) {
  const TriangleMesh sphere = shapes::icosphere(4);
  Window window(sphere, support::view_from(Vector3(5, 0, 0), Vector3::Zero()));
  change(window, [](DragSettings& s) { s.brush_pixels = 500; });
  const int front = support::vertex_at(sphere, Vector3::UnitX());
  window.drag(front, Vector2(5, 0), kAdd);
  ASSERT_NE(window.session.region(), nullptr);
  EXPECT_GT(region_of(window).size(), 100U);
  for (const int v : region_of(window)) {
    EXPECT_GT(window.host()(v, 0), 0.1);
  }
}

TEST(DragRegion, GrowsAndShrinksByARing) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 5; });
  window.click(kMiddle);
  const std::vector<int> before = region_of(window);
  window.session.grow();
  window.session.wait();
  EXPECT_GT(region_of(window).size(), before.size());
  window.session.shrink();
  window.session.wait();
  EXPECT_EQ(region_of(window), before);
  EXPECT_TRUE(window.session.ready());
}

TEST(DragRegion, WholeComponentHasNoAnchors) {
  const TriangleMesh mesh = shapes::two_pieces(3);
  Window window(mesh);
  const int top = support::vertex_at(mesh, Vector3::UnitZ());
  window.session.whole_component();
  EXPECT_NE(window.session.message().find("no handle"), std::string::npos);
  window.click(top);
  window.session.whole_component();
  window.session.wait();
  EXPECT_EQ(window.session.region()->size(), mesh.vertices.rows() / 2);
  EXPECT_EQ(window.session.region()->count(VertexClass::Anchor), 0);
}

TEST(DragRegion, HandleAloneIsRefusedWithALine) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 1e-3; });
  window.click(kMiddle);
  EXPECT_NE(window.session.message().find("handle alone"), std::string::npos);
  EXPECT_EQ(window.log.size(), 1U);
  window.drag(kMiddle, Vector2(30, 30));
  EXPECT_EQ(window.session.figures().steps, 0);
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
  change(window, [](DragSettings& s) { s.radius = 5; });
  window.drag(kMiddle, Vector2(30, 30));
  EXPECT_EQ(window.session.figures().steps, 1);
}

// --- Handles --------------------------------------------------------------------------------------------------------

TEST(DragHandle, ClicksAddAndTakeVertices) {
  Window window(plate());
  window.click(kMiddle);
  window.click(at(31, 31), kAdd);
  window.click(at(30, 32), kAdd);
  EXPECT_EQ(window.session.groups(), (std::vector<std::vector<int>>{{at(30, 30), at(30, 32), at(31, 31)}}));
  window.click(at(30, 32), kTake);
  EXPECT_EQ(window.session.groups(), (std::vector<std::vector<int>>{{at(30, 30), at(31, 31)}}));
  window.drag(at(31, 31), Vector2(20, 20));
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_LT((way.row(at(30, 30)) - way.row(at(31, 31))).norm(), 0.01 * way.row(at(30, 30)).norm());
  window.expect_consistent();
}

TEST(DragHandle, RadiusPicksTheVerticesAround) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.handle_share = 2.5 / s.radius; });
  window.click(kMiddle);
  EXPECT_TRUE(has(window.session.groups().at(0), at(32, 30)));
  EXPECT_FALSE(has(window.session.groups().at(0), at(33, 30)));
}

TEST(DragHandle, SeveralGroupsMoveOnTheirOwn) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 12; });
  window.click(kMiddle);
  window.session.next_group();
  window.click(at(36, 30));
  ASSERT_EQ(window.session.groups().size(), 2U);
  EXPECT_EQ(window.session.active_group(), 1);
  window.drag(at(36, 30), Vector2(0, 30));
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_LT(way.row(kMiddle).norm(), 0.01 * way.row(at(36, 30)).norm());
  window.drag(kMiddle, Vector2(0, -30));
  EXPECT_EQ(window.session.active_group(), 0);
  EXPECT_EQ(window.session.groups().size(), 2U);
  EXPECT_EQ(window.session.recorded().steps.at(1).handles.size(), 2U);
  window.expect_consistent();
}

TEST(DragHandle, CurveIsJoinedByShortestPathsAndMovesAsOne) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 15; });
  window.session.set_handle_mode(HandleMode::Curve);
  window.click(at(25, 30));
  window.click(at(35, 30));
  ASSERT_EQ(window.session.groups().size(), 1U);
  const std::vector<int> curve = window.session.groups()[0];
  EXPECT_EQ(curve.size(), 11U);
  for (int i = 25; i <= 35; ++i) {
    EXPECT_TRUE(has(curve, at(i, 30)));
  }
  window.click(at(35, 34));
  EXPECT_EQ(window.session.groups()[0].size(), 15U);
  window.drag(at(30, 30), Vector2(0, 25));
  EXPECT_EQ(window.session.figures().steps, 1);
  const Points way = window.host() - window.session.original().vertices;
  EXPECT_LT((way.row(at(25, 30)) - way.row(at(35, 34))).norm(), 0.01 * way.row(at(25, 30)).norm());
  window.expect_consistent();
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
    window.session.undo();
    window.session.wait();
    EXPECT_TRUE(same_bits(window.host(), states[k])) << k;
  }
  EXPECT_FALSE(window.session.can_undo());
  window.session.undo();
  EXPECT_NE(window.session.message().find("nothing to undo"), std::string::npos);
  for (int k = 1; k <= 3; ++k) {
    window.session.redo();
    window.session.wait();
    EXPECT_TRUE(same_bits(window.host(), states[k])) << k;
  }
  window.expect_consistent();
  window.session.reset();
  EXPECT_TRUE(same_bits(window.host(), states[0]));
  EXPECT_TRUE(window.session.can_redo());
}

TEST(DragSteps, UndoGoesBackToHandleAndRegionOfTheStep) {
  Window window(plate());
  window.drag(kMiddle, Vector2(20, 12));
  const std::vector<int> region = region_of(window);
  window.drag(at(50, 50), Vector2(20, 12));
  window.session.undo();
  window.session.undo();
  window.session.wait();
  EXPECT_EQ(window.session.groups(), (std::vector<std::vector<int>>{{kMiddle}}));
  EXPECT_EQ(region_of(window), region);
  window.drag(kMiddle, Vector2(-10, 5));
  EXPECT_FALSE(window.session.can_redo());
  window.expect_consistent();
}

TEST(DragSteps, OtherSettingsSolveTheLastStepAgain) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  const Points order1 = window.host();
  change(window, [](DragSettings& s) { s.edit.order = 2; });
  EXPECT_FALSE(same_bits(window.host(), order1));
  EXPECT_EQ(window.session.figures().steps, 1);
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.order, 2);
  window.expect_consistent();
  change(window, [](DragSettings& s) { s.padding = 0.3; });
  EXPECT_EQ(window.session.recorded().steps.at(0).region.padding, 0.3);
  change(window, [](DragSettings& s) { s.radius *= 1.5; });
  window.expect_consistent();
  change(window, [](DragSettings& s) {
    s.radius /= 1.5;
    s.padding = 0.1;
    s.edit.order = 1;
  });
  EXPECT_TRUE(same_bits(window.host(), order1));
  for (int k = 0; k < 5; ++k) {
    window.session.undo();  // four settings and the step
  }
  EXPECT_TRUE(same_bits(window.host(), window.session.original().vertices));
}

TEST(DragSteps, OtherSettingsLeaveTheLastStepAloneOnceSomethingElseIsPicked) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  const Points before = window.host();
  window.click(at(32, 30));
  change(window, [](DragSettings& s) { s.edit.order = 2; });
  EXPECT_TRUE(same_bits(window.host(), before));
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.order, 1);
}

TEST(DragSteps, OtherSettingsSolveTheDragInProgressAgain) {
  Window window(plate());
  window.click(kMiddle);
  window.press(kMiddle);
  window.session.move(window.at(kMiddle, Vector2(40, 0)));
  window.session.wait();
  const Points before = window.host();
  change(window, [](DragSettings& s) { s.edit.order = 2; });
  EXPECT_EQ(window.session.state(), State::Dragging);
  EXPECT_FALSE(same_bits(window.host(), before));
  change(window, [](DragSettings& s) { s.radius *= 0.5; });
  window.session.release(window.at(kMiddle, Vector2(40, 0)));
  window.session.wait();
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.order, 2);
  window.expect_consistent();
}

TEST(DragSteps, SettingsMayChangeWhileAStepIsSolvedForAgain) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  window.drag(at(32, 30), Vector2(20, 10));  // its region is a set of vertices, for which the radius means nothing
  DragSettings settings = window.session.settings();
  settings.edit.order = 2;
  window.session.set_settings(settings);
  ASSERT_EQ(window.session.state(), State::Settling);
  settings.radius *= 1.5;
  window.session.set_settings(settings);
  // And what the mouse does meanwhile is not lost.
  window.drag(at(28, 30), Vector2(0, 20));
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_EQ(window.session.figures().steps, 3);
  EXPECT_EQ(window.session.recorded().steps.at(1).settings.order, 2);
  window.expect_consistent();
}

TEST(DragSteps, ButtonReleasedWhileAStepIsSolvedForAgainHoldsNothing) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  window.press(kMiddle);
  DragSettings settings = window.session.settings();
  settings.edit.order = 2;
  window.session.set_settings(settings);
  ASSERT_EQ(window.session.state(), State::Settling);
  window.session.release(window.at(kMiddle));
  window.session.wait();
  window.session.move(window.at(kMiddle, Vector2(30, 30)));
  EXPECT_EQ(window.session.state(), State::Picked);
}

/// What is dropped while the worker is elsewhere leaves the step, and what settings are about.
TEST(DragSteps, AmendmentAndLoadCanBeDropped) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  const Points before = window.host();
  DragSettings settings = window.session.settings();
  settings.edit.order = 2;
  window.session.set_settings(settings);
  ASSERT_EQ(window.session.state(), State::Settling);
  window.session.cancel();
  window.session.wait();
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_TRUE(window.session.ready());
  EXPECT_TRUE(same_bits(window.host(), before));
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.order, 1);

  window.session.load(window.session.recorded());
  ASSERT_EQ(window.session.state(), State::Settling);
  window.session.cancel();
  window.session.wait();
  EXPECT_EQ(window.session.state(), State::Picked);
  EXPECT_TRUE(window.session.ready());
  EXPECT_TRUE(same_bits(window.host(), before));

  change(window, [](DragSettings& s) { s.edit.order = 3; });
  EXPECT_EQ(window.session.figures().steps, 1);
  EXPECT_EQ(window.session.recorded().steps.at(0).settings.order, 3);
  window.expect_consistent();
}

TEST(DragSteps, SavedEditLoadsToTheSameBits) {
  Window window(plate());
  change(window, [](DragSettings& s) { s.radius = 3; });
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

TEST(DragSteps, EditOfAnotherMeshIsRefused) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  Window other(shapes::grid(20, 20));
  other.session.load(window.session.recorded());
  other.session.wait();
  EXPECT_EQ(other.session.state(), State::Idle);
  EXPECT_NE(other.session.message().find("made for a mesh of 3600 vertices"), std::string::npos);
  EXPECT_TRUE(same_bits(other.host(), other.session.original().vertices));
}

TEST(DragSteps, EachAppliedStepIsLoggedInOneLine) {
  Window window(plate());
  window.drag(kMiddle, Vector2(40, 25));
  ASSERT_EQ(window.log.size(), 1U);
  for (const char* part : {"step 1", "Moving by", "1 vertex (1830)", "region of", "ms"}) {
    EXPECT_NE(window.log[0].find(part), std::string::npos) << window.log[0];
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

/// The middle dragged over the region's rim: the plate folds there.
TEST(DragSteps, AdviceIsGivenWhereAStepFolded) {
  Window window(plate());
  DragSettings settings = window.session.settings();
  settings.edit = support::smooth_surface_settings();
  settings.edit.rotation = DetailRotation::None;
  window.session.set_settings(settings);
  window.drag(kMiddle, Vector2(20, 10));
  ASSERT_EQ(window.log.size(), 1U);
  EXPECT_EQ(window.log[0].find("folded"), std::string::npos);
  EXPECT_EQ(window.session.figures().advice, "");
  window.session.undo();
  window.drag(kMiddle, Vector2(250, 10));
  const std::string advice = window.session.figures().advice;
  EXPECT_NE(advice.find("folded over near vertex"), std::string::npos);
  EXPECT_EQ(window.log.back().substr(window.log.back().size() - advice.size() - 2), "; " + advice);
}

}  // namespace
}  // namespace lapedit
