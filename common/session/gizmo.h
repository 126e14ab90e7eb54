// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lapedit/session/drag_motion.h"

namespace lapedit {

/// Orientation of a gizmo's axes.
enum class GizmoAxes {
  Layer,  ///< X, Y, Z of the mesh
  View,   ///< right, up and towards the viewer
  Normal  ///< Z along the surface normal at the handle
};

/// Parts of a gizmo: an arrow moves along an axis, a ring rotates about it, the scale handle scales.
enum class GizmoElement { None, MoveX, MoveY, MoveZ, TurnX, TurnY, TurnZ, Scale };

/// Arrows, rings and a scale handle at a handle group, of constant size on the screen.
///
/// A press on the handle's disc stays a free drag: the gizmo's centre is empty, arrows begin at kFree of their length,
/// and the scale handle is on the diagonal.
struct Gizmo {
  static constexpr double kFree = 0.2, kTip = 1.15, kRing = 0.8, kScale = 1;  ///< in lengths, from the centre

  Vector3 center;
  Matrix3 axes;              ///< a right-handed frame, by columns, length 1
  double length = 0;         ///< model units; 90 pixels
  bool only_arrows = false;  ///< for a handle of one vertex, which cannot be rotated or scaled

  /// Returns the tip of an arrow.
  Vector3 along(int axis, double lengths) const { return center + lengths * length * axes.col(axis); }
  /// Returns a point of a ring, at an angle in radians.
  Vector3 on_ring(int axis, double angle) const;
  /// Returns the position of the scale handle, to the upper right in the view.
  Vector3 scale_handle(const Camera& view) const;
  /// Returns whether an arrow or a ring is seen well enough to be shown and dragged: an arrow not along the line of
  /// sight, a ring not from the side, where it would cover arrows.
  bool arrow_is_seen(int axis, const Camera& view) const;
  bool ring_is_seen(int axis, const Camera& view) const;
};

/// @param normal  of the surface at the handle, any length; zero: the layer's axes replace GizmoAxes::Normal
Gizmo place_gizmo(const Vector3& center, GizmoAxes axes, const Vector3& normal, const Camera& view);

/// Returns the element under the cursor: the nearest on the screen within a few pixels, the front one of crossing
/// rings. O(1).
GizmoElement gizmo_element_at(const Gizmo& gizmo, const Cursor& cursor);

MotionKind kind_of(GizmoElement element);
/// Returns the axis of an arrow or a ring, 0 to 2; -1 for other elements.
int axis_number(GizmoElement element);
/// Returns the unit direction of the element's axis; `std::nullopt` for the scale handle.
std::optional<Vector3> axis_of(const Gizmo& gizmo, GizmoElement element);

}  // namespace lapedit
