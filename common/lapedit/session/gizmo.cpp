// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/gizmo.h"

#include <Eigen/Geometry>

namespace lapedit {
namespace {

constexpr double kArrowPixels = 90;

}  // namespace

Gizmo place_gizmo(const Vector3& center, GizmoAxes axes, const Vector3& normal, const Camera& view) {
  Gizmo gizmo;
  gizmo.center = center;
  gizmo.axes = Matrix3::Identity();
  gizmo.length = kArrowPixels * view.pixel_size(center);
  (void)axes;
  (void)normal;
  return gizmo;
}

GizmoPart gizmo_part_at(const Gizmo&, const Cursor&) {
  return GizmoPart::None;
}

MotionKind kind_of(GizmoPart part) {
  return part == GizmoPart::Scale   ? MotionKind::Scale
         : part >= GizmoPart::TurnX ? MotionKind::Rotate
                                    : MotionKind::Translate;
}

std::optional<Vector3> axis_of(const Gizmo& gizmo, GizmoPart part) {
  if (part == GizmoPart::None || part == GizmoPart::Scale) {
    return std::nullopt;
  }
  return Vector3(gizmo.axes.col((static_cast<int>(part) - 1) % 3));
}

}  // namespace lapedit
