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
struct Gizmo {
  Vector3 center;
  Matrix3 axes;       ///< a right-handed frame, by columns, length 1
  double length = 0;  ///< of an arrow, model units; rings have 0.8 of it as radius, the knob is at the centre
};

/// @param normal  of the surface at the handle, any length; zero: the layer's axes stand in for GizmoAxes::Normal
Gizmo place_gizmo(const Vector3& center, GizmoAxes axes, const Vector3& normal, const Camera& view);

/// The part under the cursor, the nearest within a few pixels. O(1).
GizmoPart gizmo_part_at(const Gizmo& gizmo, const Cursor& cursor);

MotionKind kind_of(GizmoPart part);
/// Direction of the part's axis, length 1; nothing for the knob.
std::optional<Vector3> axis_of(const Gizmo& gizmo, GizmoPart part);

}  // namespace lapedit
