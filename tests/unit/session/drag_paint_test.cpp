// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drag_support.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/session/selection.h"
#include "play.h"

// What is painted as a whole, the lasso, curves of the handle's fall-off, and drags about a pivot.
namespace lapedit::drag_paint_test {
namespace {

using support::at;
using support::kMiddle;
using support::play;
using support::Window;

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
  Window window(shapes::grid(60, 60));
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
    Window window(shapes::grid(60, 60));
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
    support::Play played(shapes::grid(60, 60));
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
  support::Play played(shapes::grid(60, 60));
  const Window& window = played.run("set radius 12; click 30,30; pivot point; click 30,36; drag 30,30 20 60; steps 1");
  EXPECT_NE(window.recorded().transform.degrees, 0);
}

TEST(DragSteps, LoadedStepsKeepTheirNames) {
  Window window(shapes::grid(60, 60));
  window.sizes(12, 0.3);
  window.drag(kMiddle, Vector2(20, 30));
  window.keys("r");
  window.session.move(window.at(Vector2(600, 500)));
  window.keys("\r");
  window.keys("tx2\r");
  Window other(shapes::grid(60, 60));
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
}  // namespace lapedit::drag_paint_test
