// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "drag_support.h"
#include "lapedit/session/drag_session.h"
#include "support.h"

// The detail of a region in a dragging session, which a step without a handle changes.
namespace lapedit::drag_detail_test {
namespace {

using support::same_bits;
using support::Window;

constexpr int kMiddle = 60 * 30 + 30;

/// A plate with a dent of depth 2 and width 4 in the middle.
TriangleMesh dented() {
  TriangleMesh mesh = shapes::grid(60, 60);
  const Vector3 middle = mesh.vertices.row(kMiddle).transpose();
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = -2 * std::exp(-(mesh.vertices.row(v) - middle.transpose()).head<2>().squaredNorm() / 16);
  }
  return mesh;
}

double depth(const DragSession& session) {
  return session.mesh().vertices.col(2).cwiseAbs().maxCoeff();
}

void set_detail(Window& window, double detail, bool passing = false) {
  DragSettings settings = window.session.settings();
  settings.edit.detail = detail;
  window.session.set_settings(settings, passing);
  window.session.wait();
}

struct Pressed : Window {
  Pressed() : Window(dented()) {
    change([](DragSettings& settings) { settings.radius = 14; });
    click(kMiddle);
  }
};

TEST(DragDetail, APressAndAValueFlattenADent) {
  Pressed window;
  set_detail(window, 0);
  EXPECT_LT(depth(window.session), 0.02) << window.session.message();
  EXPECT_EQ(window.session.recorded().steps.size(), 1U);
  EXPECT_TRUE(window.session.recorded().steps[0].handles.empty());
  set_detail(window, 0.5);
  EXPECT_NEAR(depth(window.session), 1, 0.02);
  EXPECT_EQ(window.session.recorded().steps.size(), 1U) << "the same step again";
  set_detail(window, 1);
  EXPECT_TRUE(same_bits(window.session.mesh().vertices, window.session.original().vertices));
}

TEST(DragDetail, IsReplayedToTheBit) {
  Pressed window;
  set_detail(window, 0.25);
  const Edit edit = window.session.recorded();
  const EditResult result = apply_edit(window.session.original(), edit, 1, StoredScalar::Float);
  Points replayed = window.session.original().vertices;
  for (std::size_t i = 0; i < result.vertices.size(); ++i) {
    replayed.row(result.vertices[i]) = result.positions.row(static_cast<Eigen::Index>(i));
  }
  EXPECT_TRUE(same_bits(replayed, window.session.mesh().vertices));
}

TEST(DragDetail, PassingValuesAreShownAndTheLastOneIsApplied) {
  Pressed window;
  for (const double detail : {0.8, 0.4}) {
    set_detail(window, detail, true);
    EXPECT_FALSE(window.session.has_steps());
    const PoseChange* const change = window.session.take_change();
    ASSERT_NE(change, nullptr);
    EXPECT_NEAR(change->positions.col(2).cwiseAbs().maxCoeff(), 2 * detail, 0.02);
  }
  set_detail(window, 0.4);
  EXPECT_NEAR(depth(window.session), 0.8, 0.02);
  window.undo();
  EXPECT_TRUE(same_bits(window.session.mesh().vertices, window.session.original().vertices));
  EXPECT_EQ(window.session.settings().edit.detail, 1);
  window.redo();
  EXPECT_NEAR(depth(window.session), 0.8, 0.02);
}

TEST(DragDetail, APaintedRegionNeedsNoHandle) {
  Window window(dented());
  std::vector<int> painted;
  const Points& points = window.session.mesh().vertices;
  for (int v = 0; v < static_cast<int>(points.rows()); ++v) {
    if ((points.row(v) - points.row(kMiddle)).head<2>().norm() < 14) {
      painted.push_back(v);
    }
  }
  window.session.set_painted(BrushTarget::Region, painted);
  window.session.wait();
  set_detail(window, 0.5);
  set_detail(window, 0);
  EXPECT_LT(depth(window.session), 0.02) << window.session.message();
  EXPECT_EQ(window.session.recorded().steps.size(), 1U);
}

TEST(DragDetail, BelongsToOneStep) {
  Pressed window;
  set_detail(window, 0);
  window.drag(kMiddle, {30, 0});
  ASSERT_EQ(window.session.recorded().steps.size(), 2U) << window.session.message();
  EXPECT_EQ(window.session.recorded().steps[1].settings.detail, 1);
  EXPECT_EQ(window.session.settings().edit.detail, 1);
  set_detail(window, 2);
  EXPECT_EQ(window.session.recorded().steps.size(), 2U) << "the drag again";
  EXPECT_EQ(window.session.recorded().steps[1].settings.detail, 2);
  window.click(60 * 10 + 10);
  EXPECT_EQ(window.session.settings().edit.detail, 1);
}

TEST(DragDetail, IsRefusedWithoutARegionOrItsBoundary) {
  Window window(dented());
  set_detail(window, 0);
  EXPECT_NE(window.session.message().find("no region"), std::string::npos) << window.session.message();
  EXPECT_EQ(window.session.settings().edit.detail, 1);
  window.click(kMiddle);
  window.session.whole_component();
  window.session.wait();
  set_detail(window, 0);
  EXPECT_NE(window.session.message().find("whole piece"), std::string::npos) << window.session.message();
  EXPECT_FALSE(window.session.has_steps());
}

}  // namespace
}  // namespace lapedit::drag_detail_test
