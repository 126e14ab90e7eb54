// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drag_support.h"
#include "lapedit/mesh/vertex_set.h"

// What is painted as a whole, the lasso, curves of the handle's fall-off, and drags about a pivot.
namespace lapedit::drag_paint_test {
namespace {

using support::Window;

constexpr PressModifiers kAdd{true, false}, kShift{false, true};

constexpr int at(int i, int j) {
  return 60 * i + j;
}

constexpr int kMiddle = at(30, 30);

bool has(const std::vector<int>& set, int vertex) {
  return std::binary_search(set.begin(), set.end(), vertex);
}

void stroke(Window& window, int from, int to, PressModifiers modifiers = {}) {
  window.press(from, modifiers);
  for (const double fraction : {0.25, 0.5, 0.75, 1.0}) {
    window.session.move(window.at((1 - fraction) * window.at(from).pixel + fraction * window.at(to).pixel));
  }
  window.session.release(window.at(to));
  window.session.wait();
}

Window& with_brush(Window& window) {
  window.change([](DragSettings& s) {
    s.radius = 12;
    s.brush_pixels = 12;
  });
  return window;
}

TEST(DragPaint, EachTargetIsPaintedWithoutAKey) {
  Window window(shapes::grid(60, 60));
  with_brush(window);
  window.session.set(&Tools::paint, BrushTarget::Region);
  EXPECT_TRUE(window.says("Paint the region"));
  stroke(window, at(20, 30), at(40, 30));
  EXPECT_TRUE(has(window.session.selection().region.vertices, kMiddle));
  EXPECT_TRUE(window.session.selection().groups.empty());
  window.session.key(DragKey::Brush);
  EXPECT_TRUE(window.says("Paint the handle"));
  stroke(window, at(30, 30), at(31, 30));
  ASSERT_EQ(window.session.selection().groups.size(), 1U);
  EXPECT_TRUE(has(window.session.selection().groups[0], kMiddle));
  window.session.key(DragKey::Brush);
  stroke(window, at(22, 30), at(23, 30));
  EXPECT_TRUE(has(window.session.selection().held, at(22, 30)));
  window.session.key(DragKey::Brush);
  EXPECT_FALSE(window.session.tools().paint);
  window.drag(kMiddle, Vector2(0, 20));
  EXPECT_EQ(window.session.figures().steps, 1);
  window.expect_consistent();
}

/// Presses and goes to two further vertices with a single move each.
void corner(Window& window, int from, int middle, int to) {
  window.press(from);
  window.session.move(window.at(middle));
  window.session.move(window.at(to));
  window.session.release(window.at(to));
}

/// Returns the vertices that are at most so many pixels from the way between two vertices.
std::vector<int> band(const Window& window, int from, int to, double pixels) {
  std::vector<int> near;
  const Vector2 start = window.at(from).pixel, way = window.at(to).pixel - start;
  for (int v = 0; v < window.session.mesh().vertices.rows(); ++v) {
    const Vector2 off = window.at(v).pixel - start;
    const double along = std::clamp(off.dot(way) / way.squaredNorm(), 0.0, 1.0);
    if ((off - along * way).norm() <= pixels) {
      near.push_back(v);
    }
  }
  return near;
}

TEST(DragPaint, StrokeIsABandAlongItsPath) {
  Window window(shapes::grid(60, 60));
  with_brush(window);
  window.session.set(&Tools::paint, BrushTarget::Anchors);
  corner(window, at(10, 10), at(10, 50), at(50, 50));
  const double pixels = window.session.settings().brush_pixels;
  const std::vector<int> expected =
      united(band(window, at(10, 10), at(10, 50), pixels), band(window, at(10, 50), at(50, 50), pixels));
  EXPECT_EQ(window.session.selection().held, expected);
  EXPECT_FALSE(window.says("already kept fixed")) << "its last move painted nothing more";
  corner(window, at(10, 10), at(10, 50), at(50, 50));
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
    if (!waits) {
      window.session.wait();
    }
    ASSERT_EQ(window.session.state() == DragSession::State::Settling, waits);
    window.session.press(window.at(at(50, 10)), kAdd);
    for (const int v : {at(50, 50), at(10, 50)}) {
      window.session.move(window.at(v));
    }
    window.session.release(window.at(at(10, 50)));
    window.session.wait();
    painted[waits] = window.session.selection().region.vertices;
  }
  EXPECT_TRUE(has(painted[0], at(50, 40)) && has(painted[0], at(40, 50)));
  EXPECT_EQ(painted[1], painted[0]);
}

TEST(DragPaint, InvertBlurAndClearChangeTheTargetAndAreUndone) {
  Window window(shapes::grid(60, 60));
  with_brush(window);
  window.session.set(&Tools::paint, BrushTarget::Anchors);
  stroke(window, at(20, 30), at(40, 30));
  const std::vector<int> painted = window.session.selection().held;
  ASSERT_GT(painted.size(), 20U);
  window.session.change_painted(PaintChange::Invert);
  const std::vector<int> others = window.session.selection().held;
  EXPECT_EQ(others.size(), 3600 - painted.size());
  EXPECT_FALSE(has(others, kMiddle));
  window.session.change_painted(PaintChange::Clear);
  EXPECT_TRUE(window.session.selection().held.empty());
  window.session.change_painted(PaintChange::Clear);
  EXPECT_TRUE(window.says("Nothing is painted"));
  window.undo();
  EXPECT_EQ(window.session.selection().held, others);
  window.undo();
  EXPECT_EQ(window.session.selection().held, painted);
  // A single vertex, and a notch, are not smooth.
  window.session.set_anchors({at(5, 5)});
  const std::vector<int> with_speck = window.session.selection().held;
  ASSERT_TRUE(has(with_speck, at(5, 5)));
  window.session.change_painted(PaintChange::Blur);
  EXPECT_FALSE(has(window.session.selection().held, at(5, 5)));
  EXPECT_TRUE(has(window.session.selection().held, kMiddle));
  window.undo();
  EXPECT_EQ(window.session.selection().held, with_speck);
}

TEST(DragPaint, VerticesThatTheMeshLacksAreRefused) {
  Window window(shapes::grid(60, 60));
  window.session.set_anchors({kMiddle, 3600});
  EXPECT_TRUE(window.says("The mesh has 3600 vertices")) << window.session.message();
  window.session.set_handle({-1, kMiddle});
  EXPECT_TRUE(window.says("The mesh has 3600 vertices")) << window.session.message();
  EXPECT_TRUE(window.session.selection().held.empty());
  EXPECT_TRUE(window.session.selection().groups.empty());
}

TEST(DragPaint, HandleThatIsNotThereIsNotInverted) {
  Window window(shapes::grid(60, 60));
  window.session.set(&Tools::paint, BrushTarget::Handle);
  window.session.change_painted(PaintChange::Invert);
  EXPECT_TRUE(window.says("Nothing is painted")) << window.session.message();
  window.expect_consistent();
}

TEST(DragPaint, InvertedHandleStaysInItsRegion) {
  Window window(shapes::grid(60, 60));
  with_brush(window);
  window.change([](DragSettings& s) { s.handle_fraction = 0.3; });
  window.click(kMiddle);
  const std::vector<int> region = window.region(), handle = window.session.selection().groups.at(0);
  window.session.set(&Tools::paint, BrushTarget::Handle);
  window.session.change_painted(PaintChange::Invert);
  window.session.wait();
  EXPECT_EQ(window.session.selection().groups.at(0).size(), region.size() - handle.size());
  window.session.change_painted(PaintChange::Clear);
  window.session.wait();
  EXPECT_TRUE(window.session.selection().groups.empty());
  EXPECT_EQ(window.region(), region);
  window.session.set_handle({kMiddle, at(30, 31)});
  window.session.wait();
  EXPECT_EQ(window.session.selection().groups.at(0), (std::vector<int>{kMiddle, at(30, 31)}));
  window.session.set(&Tools::paint, BrushTarget::Region);
  window.session.change_painted(PaintChange::Clear);
  window.session.wait();
  EXPECT_FALSE(window.session.selection().has_region);
}

TEST(DragFalloff, CurvesAreOfTheSameEndsAndOrdered) {
  std::vector<double> weights[4];
  for (int k = 0; k < 4; ++k) {
    Window window(shapes::grid(60, 60));
    window.change([k](DragSettings& s) {
      s.radius = 12;
      s.handle_fraction = 0.5;
      s.falloff = static_cast<Falloff>(k);
    });
    window.click(kMiddle);
    weights[k] = window.session.selection().weights.at(0);
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
  window.change([](DragSettings& s) {
    s.radius = 2;
    s.handle_fraction = 0.2;
  });
  window.click(tip);
  window.session.set(&Tools::pivot, Pivot::Boundary);
  EXPECT_TRUE(window.says("turns about the shoulder"));
  const Vector3 pivot = window.session.pivot_position();
  const std::vector<int> handle = window.session.selection().groups.at(0);
  const auto reach = [&] { return (centroid(window.session.mesh().vertices, handle) - pivot).norm(); };
  const double before = reach();
  window.drag(tip, Vector2(10, -90));
  ASSERT_EQ(window.session.figures().steps, 1) << window.session.message();
  const HandleTransform turned = window.session.recorded().steps[0].handles[0].transform;
  EXPECT_GT(std::abs(turned.degrees), 10);
  EXPECT_TRUE(turned.center && turned.translation.isZero(0));
  EXPECT_NEAR(reach(), before, 1e-3 * before) << "the limb keeps its length";
  window.drag(tip, Vector2(-20, 30), kShift);
  ASSERT_EQ(window.session.figures().steps, 2) << window.session.message();
  const HandleTransform moved = window.session.recorded().steps[1].handles[0].transform;
  EXPECT_EQ(moved.degrees, 0);
  EXPECT_GT(moved.translation.norm(), 0.1);
  window.expect_consistent();
  window.click(tip, kShift);
  EXPECT_EQ(window.session.selection().groups.at(0).size(), handle.size() - 1) << "a click removes, as ever";
}

TEST(DragPivot, SingleVertexTurnsAboutAPointToo) {
  Window window(shapes::grid(60, 60));
  window.change([](DragSettings& s) { s.radius = 12; });
  window.click(kMiddle);
  window.session.set(&Tools::pivot, Pivot::Point);
  window.click(at(30, 36));
  window.drag(kMiddle, Vector2(20, 60));
  ASSERT_EQ(window.session.figures().steps, 1) << window.session.message();
  EXPECT_NE(window.session.recorded().steps[0].handles[0].transform.degrees, 0);
  window.expect_consistent();
}

TEST(DragSteps, LoadedStepsKeepTheirNames) {
  Window window(shapes::grid(60, 60));
  window.change([](DragSettings& s) {
    s.radius = 12;
    s.handle_fraction = 0.3;
  });
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

// --- Lasso -----------------------------------------------------------------------------------------------------------

/// Draws a closed rectangle of pixels.
void draw_lasso(Window& window, const Vector2& low, const Vector2& high, PressModifiers modifiers) {
  modifiers.lasso = true;
  window.session.press(window.at(low), modifiers);
  for (const Vector2& corner : {Vector2(low.x(), high.y()), high, Vector2(high.x(), low.y())}) {
    window.session.move(window.at(corner));
  }
  window.session.release(window.at(Vector2(high.x(), low.y())));
  window.session.wait();
}

TEST(DragLasso, PaintsWhatIsVisibleInside) {
  // A sheet above a larger one, which it hides in part.
  TriangleMesh mesh = shapes::grid(30, 30);
  const TriangleMesh above = shapes::grid(8, 8);
  const auto below = static_cast<int>(mesh.vertices.rows());
  const Eigen::Index faces = mesh.faces.rows();
  mesh.vertices.conservativeResize(below + above.vertices.rows(), 3);
  mesh.vertices.bottomRows(above.vertices.rows()) = above.vertices.rowwise() + Eigen::RowVector3d(10.25, 10.25, 3);
  mesh.faces.conservativeResize(faces + above.faces.rows(), 3);
  mesh.faces.bottomRows(above.faces.rows()) = above.faces.array() + below;
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
