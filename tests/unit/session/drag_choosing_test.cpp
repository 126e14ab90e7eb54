// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "play.h"

// Choosing what moves and what holds: discs, the brush, anchors, pieces that nothing holds.
namespace lapedit::drag_choosing_test {
namespace {

using support::at;
using support::kMiddle;
using support::play;
using support::Window;

/// Seen from above, with the handle that users find.
constexpr double kUsual = 0.2;

TriangleMesh sheet() {
  return shapes::grid(60, 60);
}

TEST(DragDisc, HandleIsADiscUnlessASingleVertexIsAskedFor) {
  EXPECT_EQ(DragSettings().handle_fraction, kUsual);
  Window window(sheet());
  const Adjacency adjacency = support::adjacency_of(window.session.mesh());
  window.sizes(10, kUsual);
  window.click(kMiddle);
  for (const double fraction : {kUsual, 0.0, 0.3}) {
    window.sizes(10, fraction);
    EXPECT_EQ(window.groups().at(0), vertices_within(window.session.mesh(), adjacency, kMiddle, fraction * 10));
  }
}

/// All within the radius of a vertex, to an edge: a disc's last vertices do not lie on its circle.
void expect_counts_from(const Window& window, int vertex, double radius) {
  const DragSession& session = window.session;
  for (const int v : window.region()) {
    EXPECT_TRUE(contains(vertices_within(session.mesh(), session.adjacency(), vertex, radius + 1e-9), v)) << v;
  }
  const std::vector<int> inner = vertices_within(session.mesh(), session.adjacency(), vertex, radius - 1);
  EXPECT_EQ(united(window.region(), inner), window.region());
}

TEST(DragDisc, RegionCountsFromItsCentre) {
  Window window(sheet());
  window.sizes(10, 0.3);
  window.click(kMiddle);
  expect_counts_from(window, kMiddle, 10);
  const int anchors = window.session.shown().region()->count(VertexClass::Anchor);
  const std::vector<int> region = window.region();
  window.change([](DragSettings& s) { s.padding = 0.4; });
  EXPECT_EQ(window.region(), region);
  EXPECT_GT(window.session.shown().region()->count(VertexClass::Anchor), anchors);
  const auto disc = window.groups();
  // Both grow with the wheel, as one gesture.
  window.change([](DragSettings& s) { s.radius = 15; });
  expect_counts_from(window, kMiddle, 15);
  EXPECT_GT(window.groups().at(0).size(), disc.at(0).size());
  window.drag(kMiddle, Vector2(30, 10));
  window.expect_consistent();
  // Solved again with another radius, and taken back: the disc and what counts from it come back.
  window.change([](DragSettings& s) { s.radius = 12; });
  EXPECT_NEAR(window.session.recorded().steps.at(0).region.radius, 12 - 0.3 * 15, 1);
  window.expect_consistent();
  window.undo();
  window.change([](DragSettings& s) { s.radius = 10; });
  expect_counts_from(window, kMiddle, 10);
  EXPECT_EQ(window.groups(), disc);
}

TEST(DragDisc, NothingIsRefusedForASmallRegion) {
  Window window(sheet());
  for (const double fraction : {0.0, 0.2, 0.9}) {
    for (const double radius : {1.1, 2.0, 5.0}) {
      window.sizes(radius, fraction);
      window.session.key(DragKey::NewRegion);
      window.click(kMiddle);
      const bool possible = window.session.preparation().ready;
      EXPECT_TRUE(possible || (fraction > 0.5 && window.says("nothing would follow")))
          << fraction << ", " << radius << ": " << window.session.message();
    }
  }
}

TEST(DragGizmo, AppearsByAClickUntilAnotherHandleIsPickedAndLeavesOtherHandlesAlone) {
  Window window(sheet());
  window.sizes(12);
  window.click(kMiddle);
  window.click(kMiddle);
  ASSERT_TRUE(window.session.gizmo(window.view));
  EXPECT_TRUE(window.session.tools().gizmo_by_click);
  window.click(at(35, 30));
  EXPECT_FALSE(window.session.gizmo(window.view));
  window.session.set(&Tools::gizmo, true);
  window.click(kMiddle);
  ASSERT_TRUE(window.session.gizmo(window.view)) << "was switched on";
  // Another handle under an arrow.
  const Vector3 arrow = window.session.gizmo(window.view)->along(0, 0.6);
  const int under = support::vertex_at(window.session.mesh(), Vector3(arrow.x(), arrow.y(), 0));
  window.session.key(DragKey::NextGroup);
  window.session.set(&Tools::gizmo, false);
  window.click(under);
  window.click(kMiddle);
  window.session.set(&Tools::gizmo, true);
  ASSERT_EQ(window.groups().size(), 2U);
  window.drag(under, Vector2(0, 20));
  const HandleGroup moved = window.session.recorded().steps.at(0).handles.at(1);
  EXPECT_EQ(moved.vertices, (std::vector<int>{under}));
  EXPECT_GT(moved.transform.translation.norm(), 0);
  window.expect_consistent();
}

TEST(DragHold, PieceThatNothingHoldsIsSaidBeforeTheDrag) {
  const TriangleMesh ball = shapes::icosphere(3);
  int top = 0;
  ball.vertices.col(2).maxCoeff(&top);
  const int second = support::adjacency_of(ball).neighbours[top].first[0];
  play("set radius 100; click 0," + std::to_string(top) +
           "; says 'Nothing holds this piece of 642 vertices'; set radius 0.8; silent 'Nothing holds'; set radius 100; "
           "keys g; click 0," +
           std::to_string(second) + "; count 2; silent 'Nothing holds'",
       ball);
}

/// With a handle whose gizmo has the mesh's axes.
void show_gizmo(Window& window, double radius, double fraction = kUsual) {
  window.sizes(radius, fraction);
  window.click(kMiddle);
  EXPECT_FALSE(window.session.gizmo(window.view));
  window.session.set(&Tools::gizmo, true);
  window.session.set(&Tools::axes, GizmoAxes::Layer);
}

TEST(DragGizmo, ArrowMovesAlongItsAxisAndAClickGoesThrough) {
  Window window(sheet());
  show_gizmo(window, window.session.settings().radius);
  const std::optional<Gizmo> gizmo = window.session.gizmo(window.view);
  ASSERT_TRUE(gizmo);
  EXPECT_LT((gizmo->center - centroid(window.host(), window.groups()[0])).norm(), 1e-5);
  window.session.set_mode(HandleMode::Curve);  // what is clicked next is not to be hidden by it
  EXPECT_FALSE(window.session.gizmo(window.view));
  window.session.set_mode(HandleMode::Vertex);
  const Cursor on_arrow = window.at(window.view.pixel(gizmo->along(1, 0.7)));
  window.session.hover(on_arrow, {});
  EXPECT_EQ(window.session.gizmo_element(), GizmoElement::MoveY);
  EXPECT_EQ(window.session.hover(), nullptr);
  window.session.press(on_arrow);
  window.session.move(window.at(on_arrow.pixel + Vector2(33, -50)));
  ASSERT_NE(window.session.motion(), nullptr);
  EXPECT_EQ(window.session.gizmo_element(), GizmoElement::MoveY);
  window.session.release(window.at(on_arrow.pixel + Vector2(33, -50)));
  window.session.wait();
  ASSERT_EQ(window.session.figures().steps, 1);
  const Vector3 way = window.recorded().transform.translation;
  EXPECT_NEAR(way.y(), 50 * window.view.pixel_size(gizmo->center), 1e-9);
  EXPECT_EQ(way.x(), 0);
  EXPECT_EQ(way.z(), 0);
  window.expect_consistent();
  // A click on an arrow means the surface behind it.
  const auto before = window.groups();
  const Cursor arrow = window.at(window.view.pixel(window.session.gizmo(window.view)->along(0, 0.9)));
  window.session.press(arrow);
  window.session.release(arrow);
  window.session.wait();
  EXPECT_NE(window.groups(), before);
  EXPECT_EQ(window.session.figures().steps, 1);
}

TEST(DragGizmo, RingTurnsAboutThePivot) {
  Window window(sheet());
  show_gizmo(window, 12);
  window.session.set(&Tools::pivot, Pivot::Point);
  EXPECT_TRUE(window.says("turn about"));
  window.click(at(30, 40));
  EXPECT_GT(window.groups().at(0).size(), 1U);
  const Vector3 pivot = window.session.mesh().vertices.row(at(30, 40)).transpose();
  EXPECT_EQ(window.session.pivot_position(), pivot);
  const std::optional<Gizmo> gizmo = window.session.gizmo(window.view);
  ASSERT_TRUE(gizmo && gizmo->center == pivot);
  const auto on_ring = [&](double angle) { return window.at(window.view.pixel(gizmo->on_ring(2, angle))); };
  ASSERT_EQ(gizmo_element_at(*gizmo, on_ring(0.4)), GizmoElement::TurnZ);
  window.drag(on_ring(0.4), on_ring(0.9).pixel - on_ring(0.4).pixel);
  ASSERT_EQ(window.session.figures().steps, 1);
  const HandleTransform transform = window.recorded().transform;
  EXPECT_NEAR(transform.degrees, 0.5 * 180 / std::acos(-1.0), 1e-6);
  EXPECT_EQ(transform.center, pivot);
  // The handle keeps its distance from the pivot.
  EXPECT_NEAR((window.host().row(kMiddle).transpose() - pivot).norm(), 10, 0.1);
  window.expect_consistent();
}

TEST(DragGizmo, OfASingleVertexHasArrowsOnly) {
  Window window(sheet(), support::view_from(Vector3(-40, -50, 60), Vector3(30, 30, 0)));
  for (const bool lone : {false, true}) {
    window.session.clear();
    window.session.set(&Tools::gizmo, false);
    show_gizmo(window, window.session.settings().radius, lone ? 0 : 0.3);
    EXPECT_EQ(window.groups().at(0).size() == 1, lone);
    const std::optional<Gizmo> gizmo = window.session.gizmo(window.view);
    ASSERT_TRUE(gizmo);
    std::set<GizmoElement> elements;
    for (double x = -120; x <= 120; x += 3) {
      for (double y = -120; y <= 120; y += 3) {
        elements.insert(gizmo_element_at(*gizmo, window.at(Vector2(window.view.pixel(gizmo->center) + Vector2(x, y)))));
      }
    }
    EXPECT_EQ(elements.size(), lone ? 4U : 8U);
    for (const GizmoElement arrow : {GizmoElement::MoveX, GizmoElement::MoveY, GizmoElement::MoveZ}) {
      EXPECT_EQ(elements.count(arrow), 1U);
    }
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(gizmo->ring_is_seen(axis, window.view), !lone);  // which the picture follows
    }
  }
}

TEST(DragGizmo, BoundaryIsTheMiddleOfWhatHoldsAnArm) {
  Window window(shapes::tapered_arm(24, 60), support::view_from(Vector3(0, -12, 0), Vector3::Zero()));
  const Points& positions = window.session.mesh().vertices;
  int tip = 0;
  positions.col(0).maxCoeff(&tip);
  window.sizes(2);
  window.click(tip);
  window.session.set(&Tools::pivot, Pivot::Boundary);
  const Vector3 boundary = window.session.pivot_position();
  EXPECT_LT(boundary.x(), positions(tip, 0) - 1);
  EXPECT_LT(std::hypot(boundary.y(), boundary.z()), 0.5);
  window.session.set(&Tools::pivot, Pivot::Centroid);
  EXPECT_EQ(window.session.pivot_position(), centroid(positions, window.groups().at(0)));
}

TEST(DragMirror, PaintedHandleIsSeenAtOnceAndItsImageAtTheEnd) {
  Window window(sheet());
  window.session.set(&Tools::mirror, MirrorPlane{window.host().row(kMiddle).transpose(), Vector3::UnitX()});
  const auto counts = [&] { return std::pair(window.groups().size(), window.session.mirrored_groups().size()); };
  window.click(at(15, 30));
  ASSERT_EQ(counts(), std::pair(1UL, 2UL));
  window.session.key(DragKey::NextGroup);
  window.session.set(&Tools::paint, BrushTarget::Handle);
  window.press(at(15, 45), {true, false});
  window.session.move(window.at(at(18, 45)));
  ASSERT_EQ(window.groups().size(), 2U);
  ASSERT_GE(window.session.mirrored_groups().size(), 2U);
  EXPECT_TRUE(contains(window.session.mirrored_groups()[1], at(18, 45)));
  window.session.release(window.at(at(18, 45)));
  window.session.wait();
  ASSERT_EQ(counts(), std::pair(2UL, 4UL));
  EXPECT_EQ(window.session.group_of_image(2), 0);
  EXPECT_EQ(window.session.group_of_image(3), 1);
}

TEST(DragMirror, PaintedAnchorsHoldOnBothSides) {
  play(
      "set radius 12 brush 12; mirror 30; paint anchors; stroke 19,26 19,34; paint off; held 19,30; keep a; drag 15,30 "
      "0 40; steps 1; same held a; anchor 19,30; anchor 41,30; rests 19,30 11,30 0.1; rests 41,30 11,30 0.1; images "
      "11,30 49,30; consistent; unmirror; same held a; keys w; click 45,30; in 41,30; anchor 41,30 not",
      shapes::grid(61, 60));
}

/// A ball that is longer at one side of each axis.
TriangleMesh lopsided(const Vector3& longer) {
  TriangleMesh mesh = shapes::icosphere(4);
  for (int k = 0; k < 3; ++k)
    mesh.vertices.col(k) = mesh.vertices.col(k).cwiseMax(longer[k] * mesh.vertices.col(k)).eval();
  return mesh;
}

TEST(DragMirror, PlaneIsFoundFromTheMesh) {
  Window window(shapes::tapered_arm(24, 60, 0)), other(lopsided({3, 2, 1.5}));
  window.session.find_mirror();
  ASSERT_TRUE(window.session.tools().mirror);
  EXPECT_NEAR(window.session.tools().mirror->normal.normalized().x(), 0, 1e-3);
  other.session.find_mirror();
  EXPECT_FALSE(other.session.tools().mirror);
  EXPECT_TRUE(other.says("No plane was found"));
}

TEST(DragMirror, OtherSideIsShownUnderTheCursor) {
  Window window(shapes::grid(61, 61));
  window.sizes(6, kUsual);
  const int right = support::vertex_at(window.session.original(), Vector3(40, 30, 0));
  ASSERT_TRUE(window.hovered(window.at(right)));
  EXPECT_FALSE(window.session.hover()->mirrored_point);
  window.session.set(&Tools::mirror, MirrorPlane{Vector3(30, 0, 0), Vector3::UnitX()});
  EXPECT_FALSE(window.says("mirror image")) << window.session.message();
  const HoverPreview& seen = *window.hovered(window.at(right));
  ASSERT_TRUE(seen.mirrored_point);
  EXPECT_EQ(*seen.mirrored_point, Vector3(20, 30, 0));
  ASSERT_GT(seen.mirrored.region.rows(), 0);
  const Vector3 middle = seen.mirrored.region.colwise().mean().transpose();
  EXPECT_LT((middle - Vector3(20, 30, 0)).norm(), 0.5);
  EXPECT_NEAR((seen.mirrored.region.rowwise() - middle.transpose()).rowwise().norm().maxCoeff(), 6, 0.5);
  EXPECT_GT(seen.mirrored.disc.rows(), 0);
}

TEST(DragMirror, AsymmetricMeshIsSaid) {
  Window window(lopsided({2, 1, 1}));
  window.session.set(&Tools::mirror, MirrorPlane());
  EXPECT_TRUE(window.session.tools().mirror);
  EXPECT_TRUE(window.says("not its own mirror image")) << window.session.message();
  window.session.set(&Tools::mirror, MirrorPlane{Vector3::Zero(), Vector3::UnitY()});
  EXPECT_FALSE(window.says("mirror image")) << window.session.message();
}

TEST(DragSoft, WeightsFallOffAndAreRecorded) {
  support::Play played(sheet());
  const Edit edit =
      played.run("set radius 12 disc 0.4 falloff 2; drag 30,30 0 40; consistent; undo; redo; drag 30,30 0 -20")
          .session.recorded();
  const std::vector<double> weights = edit.steps.at(0).handles[0].weights;
  ASSERT_EQ(weights.size(), edit.steps[0].handles[0].vertices.size());
  EXPECT_EQ(*std::max_element(weights.begin(), weights.end()), 1);
  EXPECT_LT(*std::min_element(weights.begin(), weights.end()), 0.1);
  EXPECT_EQ(edit.steps.at(1).handles[0].weights, weights);
}

TEST(DragGap, NearPiecesAreOneRegion) {
  play(
      "set radius 1; click 62,2; set radius 100; says 'Nothing holds'; keep a; out 59,4; set gap 1; more region a; in "
      "59,4; drag 62,2 30 0; recorded 0 gap 1; consistent",
      shapes::together(sheet(), shapes::grid(5, 60), Vector3(59.9, 0, 0)));
}

TEST(DragHover, ShowsWhatAPressWouldTake) {
  Window window(sheet());
  window.sizes(10, kUsual);
  const HoverPreview* hover = window.hovered(window.at(kMiddle));
  ASSERT_NE(hover, nullptr);
  EXPECT_EQ(hover->kind, HoverPreview::Kind::Region);
  EXPECT_TRUE(hover->is_whole);
  ASSERT_GT(hover->region.rows(), 20);
  ASSERT_GT(hover->disc.rows(), 4);
  // Each end of the outline lies on an edge between what is within the radius and what is not.
  const Points& positions = window.session.mesh().vertices;
  GeodesicSearch search({window.session.mesh(), window.session.adjacency()});
  search.run({kMiddle}, 10);
  for (Eigen::Index i = 0; i < hover->region.rows(); ++i) {
    bool is_between = false;
    for (int v = 0; v < positions.rows(); ++v) {
      for (const int w : window.session.adjacency().neighbours[v]) {
        const double way =
            (positions.row(v) - hover->region.row(i)).norm() + (hover->region.row(i) - positions.row(w)).norm();
        is_between |= search.distance(v) <= 10 && search.distance(w) > 10 &&
                      way < (positions.row(v) - positions.row(w)).norm() + 1e-9;
      }
    }
    EXPECT_TRUE(is_between) << hover->region.row(i);
  }
  // The wheel's effect is seen at once, and what is picked is what was shown.
  window.change([](DragSettings& s) { s.radius = 5; });
  const auto larger = hover->region.rows();
  hover = window.hovered(window.at(kMiddle));
  EXPECT_LT(hover->region.rows(), larger);
  window.click(kMiddle);
  hover = window.hovered(window.at(at(30, 33)));
  ASSERT_NE(hover, nullptr);
  EXPECT_EQ(hover->kind, HoverPreview::Kind::Handle);
  EXPECT_EQ(hover->region.rows(), 0);
  EXPECT_GT(hover->disc.rows(), 0);
  window.session.hover(window.at(kMiddle), {});
  ASSERT_NE(window.session.hover(), nullptr);
  EXPECT_EQ(window.session.hover()->kind, HoverPreview::Kind::Group);
  window.session.hover(window.at(kMiddle), {true, false});
  EXPECT_EQ(window.session.hover()->kind, HoverPreview::Kind::Brush);
  window.session.leave();
  EXPECT_EQ(window.session.hover(), nullptr);
}

TEST(DragHover, WorkIsBounded) {
  Window window(shapes::grid(300, 300));
  window.change([](DragSettings& s) { s.radius = 1e6; });
  const HoverPreview* hover = window.hovered(window.at(150 * 300 + 150));
  ASSERT_NE(hover, nullptr);
  EXPECT_FALSE(hover->is_whole);
  EXPECT_EQ(hover->region.rows(), 0);
}

constexpr PressModifiers kAdd{true, false}, kShift{false, true};

void with_brush(Window& window) {
  window.change([](DragSettings& s) { s.radius = s.brush_pixels = 12; });
}

/// Returns the vertices that are at most so many pixels from the way between two vertices.
std::vector<int> band(const Window& window, int from, int to, double pixels) {
  std::vector<int> near;
  const Vector2 start = window.at(from).pixel, way = window.at(to).pixel - start;
  for (int v = 0; v < window.session.mesh().vertices.rows(); ++v) {
    const Vector2 off = window.at(v).pixel - start;
    const double along = std::clamp(off.dot(way) / way.squaredNorm(), 0.0, 1.0);
    if ((off - along * way).norm() <= pixels) near.push_back(v);
  }
  return near;
}

/// Presses and goes to two further vertices with a single move each.
void corner(Window& window, PressModifiers modifiers = {}) {
  window.press(at(50, 10), modifiers);
  for (const int v : {at(50, 50), at(10, 50)}) window.session.move(window.at(v));
  window.session.release(window.at(at(10, 50)));
}

TEST(DragPaint, StrokeIsABandAlongItsPath) {
  Window window(sheet());
  with_brush(window);
  window.session.set(&Tools::paint, BrushTarget::Anchors);
  corner(window);
  EXPECT_EQ(window.session.selection().held,
            united(band(window, at(50, 10), at(50, 50), 12), band(window, at(50, 50), at(10, 50), 12)));
  EXPECT_FALSE(window.says("already kept fixed")) << "its last move painted nothing more";
  corner(window);
  EXPECT_TRUE(window.says("already kept fixed")) << "a stroke that paints nothing says why";
  window.undo();
  EXPECT_TRUE(window.session.selection().held.empty()) << "a stroke is one action";
}

TEST(DragPaint, MovesThatWaitForAStepArePaintedToo) {
  std::vector<int> painted[2];
  for (const bool waits : {false, true}) {
    Window window(sheet());
    with_brush(window);
    window.press(at(30, 20));
    window.session.move(window.at(at(30, 22)));
    window.session.release(window.at(at(30, 22)));
    if (!waits) window.session.wait();
    ASSERT_EQ(window.session.state() == DragSession::State::Settling, waits);
    corner(window, kAdd);
    window.session.wait();
    painted[waits] = window.session.selection().region.vertices;
  }
  EXPECT_TRUE(contains(painted[0], at(50, 40)) && contains(painted[0], at(40, 50)));
  EXPECT_EQ(painted[1], painted[0]);
}

TEST(DragFalloff, CurvesAreOfTheSameEndsAndOrdered) {
  std::vector<double> weights[4];
  for (int k = 0; k < 4; ++k) {
    support::Play played(sheet());
    weights[k] = played.run("set radius 12 disc 0.5 falloff " + std::to_string(k) + "; click 30,30")
                     .session.selection()
                     .weights.at(0);
  }
  EXPECT_TRUE(weights[0].empty());
  const std::vector<double>&sharp = weights[1], &smooth = weights[2], &dome = weights[3];
  ASSERT_EQ(sharp.size(), dome.size());
  int above = 0;
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    EXPECT_LE(sharp[i], smooth[i]);
    EXPECT_LE(smooth[i], dome[i]);
    above += sharp[i] < 0.8 * smooth[i] && smooth[i] < 0.8 * dome[i] ? 1 : 0;
  }
  EXPECT_GT(above, 10);
  EXPECT_EQ(*std::max_element(sharp.begin(), sharp.end()), 1);
  EXPECT_EQ(*std::max_element(dome.begin(), dome.end()), 1);
}

TEST(DragPivot, DragTurnsAboutTheShoulderAndShiftMoves) {
  Window window(shapes::tapered_arm(24, 60), support::view_from(Vector3(0, -12, 0), Vector3::Zero()));
  int tip = 0;
  window.session.mesh().vertices.col(0).maxCoeff(&tip);
  window.sizes(2, 0.2);
  window.click(tip);
  window.session.set(&Tools::pivot, Pivot::Boundary);
  EXPECT_TRUE(window.says("turns about the shoulder"));
  const Vector3 pivot = window.session.pivot_position();
  const std::vector<int> handle = window.groups().at(0);
  const auto reach = [&] { return (centroid(window.session.mesh().vertices, handle) - pivot).norm(); };
  const double before = reach();
  window.drag(tip, Vector2(10, -90));
  ASSERT_EQ(window.session.figures().steps, 1) << window.session.message();
  const HandleTransform turned = window.recorded().transform;
  EXPECT_GT(std::abs(turned.degrees), 10);
  EXPECT_TRUE(turned.center && turned.translation.isZero(0));
  EXPECT_NEAR(reach(), before, 1e-3 * before) << "the limb keeps its length";
  window.drag(tip, Vector2(-20, 30), kShift);
  ASSERT_EQ(window.session.figures().steps, 2) << window.session.message();
  const HandleTransform moved = window.recorded(1).transform;
  EXPECT_EQ(moved.degrees, 0);
  EXPECT_GT(moved.translation.norm(), 0.1);
  window.expect_consistent();
  window.click(tip, kShift);
  EXPECT_EQ(window.groups().at(0).size(), handle.size() - 1) << "a click removes, as ever";
}

TEST(DragPivot, SingleVertexTurnsAboutAPointToo) {
  support::Play played(sheet());
  const Window& window = played.run("set radius 12; click 30,30; pivot point; click 30,36; drag 30,30 20 60; steps 1");
  EXPECT_NE(window.recorded().transform.degrees, 0);
}

TEST(DragSteps, LoadedStepsKeepTheirNames) {
  Window window(sheet());
  window.sizes(12, 0.3);
  window.drag(kMiddle, Vector2(20, 30));
  window.keys("r");
  window.session.move(window.at(Vector2(600, 500)));
  window.keys("\r");
  window.keys("tx2\r");
  Window other(sheet());
  other.session.load(window.session.recorded());
  other.session.wait();
  const auto& names = other.session.timeline().done();
  ASSERT_EQ(names.size(), 3U);
  EXPECT_EQ(names[0].name, window.session.timeline().done()[0].name);
  EXPECT_EQ(names[1].name, window.session.timeline().done()[1].name);
  EXPECT_EQ(names[1].name.find("Turning by"), 0U);
  EXPECT_EQ(names[2].name, "Moving by 2 along X");
}

/// Draws a closed rectangle of pixels.
void draw_lasso(Window& window, const Vector2& low, const Vector2& high, PressModifiers modifiers) {
  modifiers.lasso = true;
  window.session.press(window.at(low), modifiers);
  for (const Vector2& pixel : {Vector2(low.x(), high.y()), high, Vector2(high.x(), low.y())}) {
    window.session.move(window.at(pixel));
  }
  window.session.release(window.at(Vector2(high.x(), low.y())));
  window.session.wait();
}

TEST(DragLasso, PaintsWhatIsVisibleInside) {
  // A sheet above a larger one, which it hides in part.
  const TriangleMesh mesh = shapes::together(shapes::grid(30, 30), shapes::grid(8, 8), Vector3(10.25, 10.25, 3));
  const int below = 900;
  Window window(mesh);
  const auto pixel = [&](double x, double y) { return window.view.pixel(Vector3(x, y, 0)); };
  const auto expected = [&](double low, double high, bool with_above) {
    std::vector<int> vertices;
    for (int v = 0; v < static_cast<int>(mesh.vertices.rows()); ++v) {
      const double x = mesh.vertices(v, 0), y = mesh.vertices(v, 1);
      const bool hidden = v < below && x > 10.25 && x < 17.25 && y > 10.25 && y < 17.25;
      if (std::min(x, y) > low && std::max(x, y) < high && !hidden && (with_above || v < below)) {
        vertices.push_back(v);
      }
    }
    return vertices;
  };
  draw_lasso(window, pixel(5.5, 5.5), pixel(20.5, 20.5), {true, false});
  EXPECT_EQ(window.session.selection().region.vertices, expected(5.5, 20.5, true));
  draw_lasso(window, pixel(5.5, 5.5), pixel(9.5, 9.5), {false, true});
  EXPECT_EQ(window.session.selection().region.vertices, without(expected(5.5, 20.5, true), expected(5.5, 9.5, false)));
  window.undo(2);
  EXPECT_FALSE(window.session.selection().has_region);
}

TEST(DragLasso, PaintsTheTargetAndBeginsBesideTheMesh) {
  Window window(shapes::grid(30, 30));
  window.click(15 * 30 + 15);
  window.session.set(&Tools::paint, std::optional(BrushTarget::Anchors));
  draw_lasso(window, {1, 1}, {support::kWidth / 2, support::kHeight - 1}, {true, false});
  EXPECT_GT(window.session.selection().held.size(), 300U);
  EXPECT_FALSE(window.session.lasso());
  window.session.press(window.at(Vector2(1, 1)), {true, false, true});
  window.session.release(window.at(Vector2(1, 1)));
  EXPECT_GT(window.session.selection().held.size(), 300U) << "a click without a line paints nothing";
}

}  // namespace
}  // namespace lapedit::drag_choosing_test
