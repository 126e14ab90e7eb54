// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lapedit/session/drag_motion.h"

namespace lapedit {

/// Which way a gizmo's axes go.
enum class GizmoAxes {
  Layer,  ///< X, Y, Z of the mesh
  View,   ///< right, up and towards the viewer
  Normal  ///< Z along the surface normal at the handle
};

/// What of a gizmo can be dragged: an arrow to move along, a ring to turn about, the knob to scale.
enum class GizmoPart { None, MoveX, MoveY, MoveZ, TurnX, TurnY, TurnZ, Scale };

/// Arrows, rings and a knob at a handle group, of constant size on the screen.
///
/// A press on the handle's own disc stays a free drag: nothing of the gizmo is at its centre, arrows begin at kFree of
/// their length, and the knob is out on the picture's diagonal.
struct Gizmo {
  static constexpr double kFree = 0.2, kTip = 1.15, kRing = 0.8, kKnob = 1;  ///< in lengths, from the centre

  Vector3 center;
  Matrix3 axes;              ///< a right-handed frame, by columns, length 1
  double length = 0;         ///< model units; 90 pixels
  bool only_arrows = false;  ///< of a handle of one vertex, which has nothing to rotate or scale

  /// Of an arrow.
  Vector3 along(int axis, double lengths) const { return center + lengths * length * axes.col(axis); }
  /// Of a ring, at an angle in radians.
  Vector3 on_ring(int axis, double angle) const;
  /// To the right and up in the picture.
  Vector3 knob(const Camera& view) const;
  /// Whether an arrow, or a ring, is seen well enough to be shown and dragged: not along the sight, and not from the
  /// side, where it would cover arrows.
  bool arrow_is_seen(int axis, const Camera& view) const;
  bool ring_is_seen(int axis, const Camera& view) const;
};

/// @param normal  of the surface at the handle, any length; zero: the layer's axes stand in for GizmoAxes::Normal
Gizmo place_gizmo(const Vector3& center, GizmoAxes axes, const Vector3& normal, const Camera& view);

/// The part under the cursor, the nearest on the screen within a few pixels; of rings that cross, what is in front.
/// O(1).
GizmoPart gizmo_part_at(const Gizmo& gizmo, const Cursor& cursor);

MotionKind kind_of(GizmoPart part);
/// 0, 1, 2 of an arrow or a ring, -1 of others.
int axis_number(GizmoPart part);
/// Direction of the part's axis, length 1; nothing for the knob.
std::optional<Vector3> axis_of(const Gizmo& gizmo, GizmoPart part);

}  // namespace lapedit
