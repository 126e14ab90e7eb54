// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/gizmo.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lapedit {
namespace {

constexpr double kLengthPixels = 90, kPickPixels = 7, kScalePixels = 9;
/// Pixels added to the distance from a ring's far half, which other elements cover.
constexpr double kBehindPixels = 3;
/// Of the angle between sight and arrow, or sight and a ring's plane: on a flatter ring a pixel would be too large an
/// angle.
constexpr double kLeastSine = 0.2, kLeastSineOfRing = 0.35;
constexpr int kCorners = 64;  // of a ring

double distance_to_segment(const Vector2& point, const Vector2& from, const Vector2& to) {
  const Vector2 direction = to - from;
  const double length = direction.squaredNorm();
  const double fraction = length > 0 ? std::clamp(direction.dot(point - from) / length, 0.0, 1.0) : 0;
  return (point - from - fraction * direction).norm();
}

/// Returns the distance from the cursor to a ring in pixels.
double distance_to_ring(const Gizmo& gizmo, int axis, const Cursor& cursor) {
  const Vector3 sight = cursor.view.toward_viewer(gizmo.center);
  double nearest = HUGE_VAL;
  Vector3 from = gizmo.on_ring(axis, 0);
  for (int i = 1; i <= kCorners; ++i) {
    const Vector3 to = gizmo.on_ring(axis, 2 * std::acos(-1.0) * i / kCorners);
    const double pixels = distance_to_segment(cursor.pixel, cursor.view.pixel(from), cursor.view.pixel(to));
    const bool behind = ((from + to) / 2 - gizmo.center).dot(sight) < 0;
    nearest = std::min(nearest, pixels + (behind ? kBehindPixels : 0));
    from = to;
  }
  return nearest;
}

}  // namespace

Vector3 Gizmo::on_ring(int axis, double angle) const {
  return center +
         kRing * length * (std::cos(angle) * axes.col((axis + 1) % 3) + std::sin(angle) * axes.col((axis + 2) % 3));
}

Vector3 Gizmo::scale_handle(const Camera& view) const {
  const double pixels = std::sqrt(0.5) * kScale * kLengthPixels;
  return view.beside(center, view.pixel(center) + Vector2(pixels, -pixels));
}

bool Gizmo::arrow_is_seen(int axis, const Camera& view) const {
  return axes.col(axis).cross(view.toward_viewer(center)).norm() > kLeastSine && view.in_front(along(axis, kTip));
}

bool Gizmo::ring_is_seen(int axis, const Camera& view) const {
  return !only_arrows && std::abs(axes.col(axis).dot(view.toward_viewer(center))) > kLeastSineOfRing &&
         view.in_front(center);
}

Gizmo place_gizmo(const Vector3& center, GizmoAxes axes, const Vector3& normal, const Camera& view) {
  Gizmo gizmo{center, Matrix3::Identity(), kLengthPixels * view.pixel_size(center)};
  const double length = normal.stableNorm();
  if (axes == GizmoAxes::View) {
    gizmo.axes.col(2) = view.toward_viewer(center);
    const Vector3 right = view.beside(center, view.pixel(center) + Vector2(1, 0)) - center;
    gizmo.axes.col(1) = gizmo.axes.col(2).cross(right).stableNormalized();
    gizmo.axes.col(0) = gizmo.axes.col(1).cross(gizmo.axes.col(2));
  } else if (axes == GizmoAxes::Normal && length > 0 && std::isfinite(length)) {
    gizmo.axes.col(2) = normal / length;
    // Takes the layer's axis that is most nearly tangent, so that the frame does not rotate with the view.
    Eigen::Index most_tangent = 0;
    gizmo.axes.col(2).cwiseAbs().minCoeff(&most_tangent);
    gizmo.axes.col(1) = gizmo.axes.col(2).cross(Vector3(Vector3::Unit(most_tangent))).normalized();
    gizmo.axes.col(0) = gizmo.axes.col(1).cross(gizmo.axes.col(2));
  }
  return gizmo;
}

GizmoElement gizmo_element_at(const Gizmo& gizmo, const Cursor& cursor) {
  const Camera& view = cursor.view;
  if (!view.valid() || !cursor.pixel.allFinite() || !view.in_front(gizmo.center)) {
    return GizmoElement::None;
  }
  const double from_center = (cursor.pixel - view.pixel(gizmo.center)).norm();
  if (!(from_center > Gizmo::kFree * kLengthPixels)) {
    return GizmoElement::None;
  }
  GizmoElement element = GizmoElement::None;
  double nearest = kPickPixels;
  const auto offer = [&](GizmoElement offered, double pixels) {
    if (pixels < nearest) {
      nearest = pixels;
      element = offered;
    }
  };
  if (!gizmo.only_arrows && (cursor.pixel - view.pixel(gizmo.scale_handle(view))).norm() < kScalePixels) {
    return GizmoElement::Scale;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (gizmo.arrow_is_seen(axis, view)) {
      offer(static_cast<GizmoElement>(static_cast<int>(GizmoElement::MoveX) + axis),
            distance_to_segment(cursor.pixel, view.pixel(gizmo.along(axis, Gizmo::kFree)),
                                view.pixel(gizmo.along(axis, Gizmo::kTip))));
    }
    if (gizmo.ring_is_seen(axis, view)) {
      offer(static_cast<GizmoElement>(static_cast<int>(GizmoElement::TurnX) + axis),
            distance_to_ring(gizmo, axis, cursor));
    }
  }
  return element;
}

MotionKind kind_of(GizmoElement element) {
  return element == GizmoElement::Scale   ? MotionKind::Scale
         : element >= GizmoElement::TurnX ? MotionKind::Rotate
                                          : MotionKind::Translate;
}

int axis_number(GizmoElement element) {
  return element == GizmoElement::None || element == GizmoElement::Scale ? -1 : (static_cast<int>(element) - 1) % 3;
}

std::optional<Vector3> axis_of(const Gizmo& gizmo, GizmoElement element) {
  const int axis = axis_number(element);
  return axis < 0 ? std::nullopt : std::optional<Vector3>(gizmo.axes.col(axis));
}

}  // namespace lapedit
