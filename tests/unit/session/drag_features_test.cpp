// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "bodies.h"
#include "drag_support.h"

namespace lapedit::drag_features_test {
namespace {

using support::Window;

/// A ball of radius 1 with a horn along x and, if wanted, an eye under its surface at z.
TriangleMesh creature(int levels, bool with_eye = false, double size = 1) {
  TriangleMesh mesh = shapes::icosphere(levels);
  for (auto vertex : mesh.vertices.rowwise()) {
    const double angle = std::acos(std::min(1.0, std::max(-1.0, vertex.x())));
    vertex *= 1 + std::exp(-std::pow(angle / 0.2, 4));
  }
  if (with_eye) {
    TriangleMesh eye = shapes::icosphere(2);
    eye.vertices *= 0.15;
    mesh = shapes::together(mesh, eye, Vector3(0, 0, 0.8));
  }
  mesh.vertices *= size;
  return mesh;
}

/// The settings of a newcomer.
void as_found(Window& window) {
  window.session.set_settings(settings_for(window.session.original()));
}

struct Given {
  int levels;
  double size;
};

/// A creature with the settings of a newcomer, who knows the tip of its horn and two positions on its ball.
class DragFeatures : public testing::TestWithParam<Given> {
 protected:
  explicit DragFeatures(bool with_eye = false)
      : size(GetParam().size), window(creature(GetParam().levels, with_eye, size)) {
    as_found(window);
  }
  int vertex_at(double x, double y, double z) const {
    return support::vertex_at(window.session.mesh(), size * Vector3(x, y, z));
  }

  const double size;
  Window window;
  const int tip = vertex_at(2, 0, 0), pole = vertex_at(0, 0, 1);
};
INSTANTIATE_TEST_SUITE_P(Sizes, DragFeatures, testing::Values(Given{4, 1}, Given{5, 0.01}, Given{5, 300}));

TEST_P(DragFeatures, FirstRadiusIsThatOfTheProtrusion) {
  const double usual = window.session.settings().first_radius;
  const HoverPreview* const preview = window.hovered(window.at(tip, Vector2(-2, 0)));
  ASSERT_NE(preview, nullptr);
  const double shown = preview->radius;
  window.click(tip);
  const double radius = window.session.settings().radius;
  EXPECT_NEAR(shown, radius, 0.3 * radius);
  EXPECT_GT(radius, 0.9 * size);
  EXPECT_LT(radius, 1.9 * size);
  // The horn follows, the other side of the ball does not.
  for (const int v : window.region()) EXPECT_GT(window.session.mesh().vertices(v, 0), 0.3 * size);
  window.session.clear();
  window.click(vertex_at(-0.5, 0, 0.87));
  EXPECT_EQ(window.session.settings().radius, usual) << "nothing stands out there";
  EXPECT_EQ(window.session.settings().first_radius, usual);
}

const TriangleMesh& person() {
  static const TriangleMesh mesh = shapes::person();  // takes a second
  return mesh;
}

TEST(DragPerson, FirstRadiusIsThatOfALimbButNotOfTheBody) {
  Window window(person(), support::view_from(Vector3(0, 0, 9), Vector3::Zero(), Vector3::UnitY()));
  as_found(window);
  const double usual = window.session.settings().first_radius;
  const struct {
    const char* name;
    Vector3 at;
    bool is_limb;
  } spots[] = {{"belly", Vector3(0, 0.3, 0.3), false},       {"chest", Vector3(0.1, 0.7, 0.3), false},
               {"thigh", Vector3(-0.2, -0.7, 0.2), false},   {"hip", Vector3(0.1, -0.35, 0.2), false},
               {"hand", Vector3(1.05, -0.3, 0.16), true},    {"foot", Vector3(0.3, -1.6, 0.35), true},
               {"forearm", Vector3(0.9, -0.05, 0.15), true}, {"shin", Vector3(0.27, -1.3, 0.1), true}};
  for (const auto& spot : spots) {
    window.session.clear();
    window.click(support::vertex_at(window.session.mesh(), spot.at));
    ASSERT_NE(window.session.shown().region(), nullptr) << spot.name;
    EXPECT_EQ(window.session.settings().radius != usual, spot.is_limb) << spot.name;
    EXPECT_LT(window.region().size(), window.session.mesh().vertices.rows() / 3) << spot.name;
  }
}

TEST_P(DragFeatures, RadiusThatTheUserSetsIsKept) {
  window.change([this](DragSettings& s) { s.radius = 0.5 * size; });
  window.click(tip);
  EXPECT_EQ(window.session.settings().radius, 0.5 * size);
  EXPECT_EQ(window.session.settings().first_radius, 0);
  // Other settings do not count as a radius, and those of the beginning start again.
  window.session.clear();
  as_found(window);
  window.change([](DragSettings& s) { s.padding = 0.2; });
  window.click(tip);
  EXPECT_GT(window.session.settings().radius, 0.9 * size);
}

TEST_P(DragFeatures, HandleIsAFractionOfTheRadiusShown) {
  window.click(tip);
  const std::vector<std::vector<int>> handle = window.groups();
  const std::size_t region = window.region().size();
  window.change([](DragSettings& s) { s.radius *= 1.5, s.handle_fraction /= 1.5; });
  EXPECT_EQ(window.groups(), handle);
  EXPECT_GT(window.region().size(), region);
  window.change([](DragSettings& s) { s.handle_fraction *= 2; });
  EXPECT_GT(window.groups().at(0).size(), handle.at(0).size());
}

class DragEye : public DragFeatures {
 protected:
  DragEye() : DragFeatures(true) {}
};
INSTANTIATE_TEST_SUITE_P(Sizes, DragEye, testing::Values(Given{4, 1}, Given{5, 0.01}, Given{5, 300}));

TEST_P(DragEye, ComesAlongUnlessItIsExcluded) {
  const auto own = shapes::icosphere(GetParam().levels).vertices.rows();
  window.sizes(1.4 * size, 0.2);
  window.click(pole);
  EXPECT_EQ(window.session.figures().pieces, 1);
  const Points before = window.host();
  // Also in the region that the first step leaves.
  for (int step = 1; step <= 2; ++step) {
    window.drag(pole, Vector2(30, 10));
    EXPECT_EQ(window.session.figures().pieces, 1) << step;
    for (Eigen::Index v = own; v < before.rows(); ++v) {
      EXPECT_GT((window.host().row(v) - before.row(v)).norm(), 0.02 * step * size);
    }
    window.expect_consistent();
  }
  window.undo(2);
  EXPECT_TRUE(support::same_bits(window.host(), before));
  window.change([](DragSettings& s) { s.pieces = false; });
  EXPECT_EQ(window.session.figures().pieces, 0);
  window.drag(pole, Vector2(30, 10));
  EXPECT_TRUE(window.session.unconnected().empty());
  EXPECT_TRUE(
      support::same_bits(window.host().bottomRows(before.rows() - own), before.bottomRows(before.rows() - own)));
  window.expect_consistent();
}

TEST_P(DragFeatures, WideStretchIsWarnedOfUntilItIsUndone) {
  window.sizes(0.8 * size, 0.2);
  window.drag(pole, Vector2(10, 0));
  EXPECT_TRUE(window.session.warning().empty()) << window.session.warning();
  window.undo();
  window.keys(size == 300 ? "tz450\r" : size == 1 ? "tz1.5\r" : "tz0.015\r");
  support::expect_contains(window.session.warning(), "of the region became more than 1.6 times as long");
  window.undo();
  EXPECT_TRUE(window.session.warning().empty());
  EXPECT_FALSE(window.session.figures().report);
}

TEST_P(DragFeatures, FoldedTrianglesAreListed) {
  window.sizes(0.6 * size, 0.4);
  window.drag(pole, Vector2(250, 0));
  ASSERT_TRUE(window.session.figures().report);
  const auto folds = window.session.figures().report->causes.folds;
  ASSERT_FALSE(folds.empty()) << window.session.warning();
  const std::string count = std::to_string(folds.size()) + " triangle";
  EXPECT_EQ(window.session.warning().find(count), 0U) << window.session.warning();
  for (const auto& fold : folds) {
    for (const int v : fold) EXPECT_TRUE(contains(window.region(), v));
  }
}

}  // namespace
}  // namespace lapedit::drag_features_test
