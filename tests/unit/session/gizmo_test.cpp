// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/gizmo.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "drag_support.h"

namespace lapedit::gizmo_test {
namespace {

const Vector3 kCenter(1, 2, 3), kNoNormal = Vector3::Zero();
const Vector3 kEyes[] = {{8, -6, 9}, {-7, 5, 10}, {1.5, 2.5, 16}, {-4, -9, 4}};

Camera seen_from(const Vector3& eye) {
  return support::view_from(eye, Vector3(1.2, 1.9, 3.1), Vector3::UnitY());
}

Cursor over(const Camera& view, const Vector3& point, const Vector2& off = Vector2::Zero()) {
  return {view, view.pixel(point) + off};
}

GizmoElement arrow(int axis) {
  return static_cast<GizmoElement>(static_cast<int>(GizmoElement::MoveX) + axis);
}

GizmoElement ring(int axis) {
  return static_cast<GizmoElement>(static_cast<int>(GizmoElement::TurnX) + axis);
}

/// Turned and mirrored as a layer may be.
Camera mirrored() {
  const Camera view = seen_from(kEyes[0]);
  Eigen::Matrix4d to_clip = Eigen::Matrix4d::Identity();
  for (int k = 0; k < 4; ++k) {
    const Vector3 corner = k < 3 ? Vector3(Vector3::Unit(k)) : Vector3(Vector3::Zero());
    const Vector2 pixel = view.pixel(corner);
    to_clip(0, k) = pixel.x() / 400 - 1;
    to_clip(1, k) = 1 - pixel.y() / 300;
    to_clip(2, k) = -0.05 * view.toward_viewer(corner).dot(corner);
  }
  for (int k = 0; k < 3; ++k) to_clip.col(k) -= to_clip.col(3);  // the affine map through these
  to_clip.row(3) << 0, 0, 0, 1;
  to_clip.col(0) = -to_clip.col(0);
  return Camera(to_clip, 800, 600);
}

TEST(Gizmo, FramesAreRightHandedAndOfTheSameSizeOnTheScreen) {
  for (const Vector3& eye : kEyes) {
    const Camera view = seen_from(eye);
    for (const GizmoAxes axes : {GizmoAxes::Layer, GizmoAxes::View, GizmoAxes::Normal}) {
      const Gizmo gizmo = place_gizmo(kCenter, axes, Vector3(3, -1, 2), view);
      EXPECT_LT((gizmo.axes.transpose() * gizmo.axes - Matrix3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(gizmo.axes.determinant(), 1, 1e-12);
      EXPECT_NEAR(gizmo.length / view.pixel_size(kCenter), 90, 1e-9);
    }
    EXPECT_EQ(place_gizmo(kCenter, GizmoAxes::Layer, Vector3(3, -1, 2), view).axes, Matrix3::Identity());
    EXPECT_EQ(place_gizmo(kCenter, GizmoAxes::Normal, kNoNormal, view).axes, Matrix3::Identity());
    EXPECT_LT((place_gizmo(kCenter, GizmoAxes::Normal, Vector3(0, 0, -4), view).axes.col(2) + Vector3::UnitZ()).norm(),
              1e-12);
    const Gizmo with_view = place_gizmo(kCenter, GizmoAxes::View, kNoNormal, view);
    EXPECT_LT((with_view.axes.col(2) - view.toward_viewer(kCenter)).norm(), 1e-12);
    const Vector2 right = view.pixel(with_view.along(0, 1)) - view.pixel(kCenter);
    const Vector2 up = view.pixel(with_view.along(1, 1)) - view.pixel(kCenter);
    EXPECT_NEAR(right.x(), 90, 5);
    EXPECT_NEAR(up.y(), -90, 5);
  }
}

TEST(Gizmo, ArrowsAreTakenAlongTheirLengthAndRingsOnTheirNearHalf) {
  int arrows = 0, rings = 0;
  for (const Vector3& eye : kEyes) {
    const Camera view = seen_from(eye);
    const Gizmo gizmo = place_gizmo(kCenter, GizmoAxes::Layer, kNoNormal, view);
    for (int axis = 0; axis < 3; ++axis) {
      if (gizmo.arrow_is_seen(axis, view)) {
        EXPECT_EQ(gizmo_element_at(gizmo, over(view, gizmo.along(axis, 1.1))), arrow(axis)) << axis;
        ++arrows;
      }
      // Where no other element crosses: between the arrows.
      for (int k = 0; k < 8 && gizmo.ring_is_seen(axis, view); ++k) {
        const Vector3 position = gizmo.on_ring(axis, 0.8 * std::acos(-1.0) * k + 0.8);
        bool alone = (position - kCenter).dot(view.toward_viewer(kCenter)) > 0;
        for (int other = 0; other < 3; ++other) {
          Gizmo without = gizmo;
          without.axes.setZero();
          without.axes.col(other) = gizmo.axes.col(other);
          const GizmoElement its = gizmo_element_at(without, over(view, position));
          alone = alone && (its == GizmoElement::None || its == ring(axis));
        }
        if (alone) {
          EXPECT_EQ(gizmo_element_at(gizmo, over(view, position, Vector2(1, -1))), ring(axis)) << axis << " " << k;
          ++rings;
        }
      }
    }
    EXPECT_EQ(gizmo_element_at(gizmo, over(view, gizmo.scale_handle(view), Vector2(3, 3))), GizmoElement::Scale);
  }
  EXPECT_GE(arrows, 10);
  EXPECT_GE(rings, 10);
}

TEST(Gizmo, LeavesThePressOnTheHandleAlone) {
  for (const Vector3& eye : kEyes) {
    const Camera view = seen_from(eye);
    const Gizmo gizmo = place_gizmo(kCenter, GizmoAxes::Layer, kNoNormal, view);
    for (double angle = 0; angle < 6.3; angle += 0.1) {
      const Vector2 off = 17 * Vector2(std::cos(angle), std::sin(angle));
      EXPECT_EQ(gizmo_element_at(gizmo, over(view, kCenter, off)), GizmoElement::None);
    }
    EXPECT_EQ(gizmo_element_at(gizmo, over(view, kCenter, Vector2(-150, 60))), GizmoElement::None);
  }
}

TEST(Gizmo, WhatIsSeenFromItsEndOrSideIsNotTaken) {
  const Camera view = support::view_from(kCenter + Vector3(0, 0, 9), kCenter, Vector3::UnitY());
  const Gizmo gizmo = place_gizmo(kCenter, GizmoAxes::Layer, kNoNormal, view);
  EXPECT_FALSE(gizmo.arrow_is_seen(2, view));
  EXPECT_FALSE(gizmo.ring_is_seen(0, view));
  EXPECT_TRUE(gizmo.ring_is_seen(2, view));
  // The ring about X covers the arrow along Y: there the arrow is taken, and below it nothing.
  EXPECT_EQ(gizmo_element_at(gizmo, over(view, kCenter + 0.5 * gizmo.length * Vector3::UnitY())), GizmoElement::MoveY);
  EXPECT_EQ(gizmo_element_at(gizmo, over(view, kCenter - 0.5 * gizmo.length * Vector3::UnitY())), GizmoElement::None);
  EXPECT_EQ(gizmo_element_at(gizmo, over(view, kCenter - 0.8 * gizmo.length * Vector3::UnitY())), GizmoElement::TurnZ);
}

TEST(Gizmo, TheNearHalfOfARingIsPreferredToTheFarHalfOfAnother) {
  int crossings = 0;
  for (const Vector3& eye : kEyes) {
    const Camera view = seen_from(eye);
    const Gizmo gizmo = place_gizmo(kCenter, GizmoAxes::Layer, kNoNormal, view);
    const Vector3 sight = view.toward_viewer(kCenter);
    for (double angle = 0; angle < 6.3; angle += 0.02) {
      for (int k = 0; k < 9; ++k) {
        const int axis = k / 3, other = k % 3;
        const Vector3 far = gizmo.on_ring(axis, angle);
        for (double along = 0; along < 6.3 && axis != other && gizmo.ring_is_seen(other, view); along += 0.02) {
          const Vector3 near = gizmo.on_ring(other, along);
          if ((far - kCenter).dot(sight) < -0.05 * gizmo.length && (near - kCenter).dot(sight) > 0.05 * gizmo.length &&
              (view.pixel(far) - view.pixel(near)).norm() < 2) {
            EXPECT_NE(gizmo_element_at(gizmo, over(view, far)), ring(axis));
            ++crossings;
          }
        }
      }
    }
  }
  EXPECT_GT(crossings, 10);
}

TEST(Gizmo, ItsRingsTurnWhatIsUnderTheCursorAlongWithIt) {
  int turned = 0;
  std::vector<Camera> views = {mirrored()};
  for (const Vector3& eye : kEyes) views.push_back(seen_from(eye));
  for (const Camera& view : views) {
    ASSERT_TRUE(view.valid());
    const Gizmo gizmo = place_gizmo(kCenter, GizmoAxes::Layer, kNoNormal, view);
    for (int axis = 0; axis < 3; ++axis) {
      if (!gizmo.ring_is_seen(axis, view)) continue;
      DragMotion m(MotionKind::Rotate, kCenter, kCenter, kNoNormal, over(view, gizmo.on_ring(axis, 0.3)));
      m.hold(gizmo.axes.col(axis));
      EXPECT_FALSE(m.moves());
      EXPECT_LT((m.arm() - (gizmo.on_ring(axis, 0.3) - kCenter).normalized()).norm(), 1e-9);
      for (double angle = 0.5; angle < 9; angle += 0.5) {  // more than once round
        m.move(over(view, gizmo.on_ring(axis, angle)));
        EXPECT_NEAR(m.transform().degrees, (angle - 0.3) * 180 / std::acos(-1.0), 1e-6);
        EXPECT_EQ(m.transform().axis, gizmo.axes.col(axis));
      }
      ++turned;
    }
  }
  EXPECT_GE(turned, 6);
}

TEST(Gizmo, ItsArrowsMoveWhatIsUnderTheCursorAlongWithIt) {
  for (const Vector3& eye : kEyes) {
    const Camera view = seen_from(eye);
    const Gizmo gizmo = place_gizmo(kCenter, GizmoAxes::Normal, Vector3(1, -2, 2), view);
    for (int axis = 0; axis < 3; ++axis) {
      DragMotion m(MotionKind::Translate, kCenter, kCenter, kNoNormal, over(view, gizmo.along(axis, 1)));
      m.hold(gizmo.axes.col(axis));
      m.move(over(view, gizmo.along(axis, 1.7)));
      EXPECT_LT((m.transform().translation - 0.7 * gizmo.length * gizmo.axes.col(axis)).norm(), 1e-9 * gizmo.length);
      m.toggle_lock(AxisLock::X);
      EXPECT_EQ(m.transform().translation.y(), 0);
    }
  }
}

}  // namespace
}  // namespace lapedit::gizmo_test
