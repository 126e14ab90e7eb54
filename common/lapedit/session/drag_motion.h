// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/camera.h"

namespace lapedit {

/// Where the mouse is and what shows there. Pixels as in Camera.
struct Cursor {
  Camera view;
  Vector2 pixel = Vector2::Zero();
  bool snap = false;  ///< amounts go in steps, while a modifier is held
};

enum class MotionKind { Translate, Rotate, Scale };
enum class AxisLock { None, X, Y, Z, Normal, Gizmo };

/// From mouse and typed numbers to the transform of a handle group.
///
/// Translation follows the cursor in the plane parallel to the picture, or along the locked axis as far as the nearest
/// point to the cursor's ray. Rotation goes about the line of sight or the locked axis by the angle that the cursor
/// goes about the centre on the screen; about the axis of a gizmo's ring by the angle that it goes along the ring.
/// Scale is the growth of the cursor's distance from the centre on the screen.
/// With Cursor::snap angles go in steps of 15 degrees, factors in steps of 0.1, and lengths in steps of 1, 2 or 5 times
/// a power of ten that show as 10 to 25 pixels. A typed number replaces what the mouse says; a typed angle counts in
/// the direction that the mouse has turned to. The view may change on the way.
class DragMotion {
 public:
  /// @param grab      the point of the surface that is to stay under the cursor
  /// @param centroid  of the handle group: of rotation and scale, where no pivot is given
  /// @param normal    of the surface at the handle, any length; zero if it has none
  /// @param pivot     another centre of rotation and scale, which transform() then names
  DragMotion(MotionKind kind, const Vector3& grab, const Vector3& centroid, const Vector3& normal, const Cursor& cursor,
             const std::optional<Vector3>& pivot = std::nullopt);

  /// Begins held to an axis of a gizmo, of any length but zero.
  void hold(const Vector3& axis);

  MotionKind kind() const { return kind_; }
  AxisLock lock() const { return lock_; }
  /// The same lock again frees it. @return false if there is no such axis: a surface without a normal
  bool toggle_lock(AxisLock lock);
  /// Direction of the locked axis, length 1.
  std::optional<Vector3> axis() const;
  const Vector3& grab() const { return grab_; }
  /// Of rotation and scale.
  const Vector3& center() const { return center_; }
  /// Direction from the centre that the mouse took hold in for a rotation: of length 1, at a right angle to the axis
  /// (zero if it is along it).
  const Vector3& arm() const { return arm_; }

  void move(const Cursor& cursor);
  /// 0-9 . or - (which changes the sign). @return false if that gives no number
  bool type(char character);

  /// Always one that can be resolved: none at all where the view gives no number.
  HandleTransform transform() const;
  bool moves() const;        ///< whether the transform is another one than at the beginning
  double step() const;       ///< what amounts are multiples of: degrees, model units or a factor; 0: they are not
  std::string text() const;  ///< "Moving by 0.5 along Y"

 private:
  Vector3 translation_by_mouse() const;
  double along_axis(const Cursor& cursor, double otherwise) const;
  HandleTransform transform_by_mouse() const;
  HandleTransform wanted() const;
  double angle_at(const Cursor& cursor) const;
  double screen_angle(const Cursor& cursor) const;
  double ring_angle(const Cursor& cursor) const;
  std::optional<Vector3> on_ring(const Cursor& cursor) const;
  double screen_distance(const Cursor& cursor) const;
  void restart(const Cursor& cursor);
  void begin_angle();

  MotionKind kind_;
  AxisLock lock_ = AxisLock::None;
  Vector3 grab_, center_, normal_;
  bool names_center_;  // it is not what a transform without a centre goes about
  Vector3 gizmo_axis_ = Vector3::Zero();
  Vector3 arm_ = Vector3::Zero();
  Vector3 sight_;          // from the centre towards the viewer, when the motion began
  Cursor start_, cursor_;  // start_ has the view of cursor_
  // What the mouse did before the view changed last.
  Vector3 translation_before_ = Vector3::Zero();
  double factor_before_ = 1;
  double along_ = 0;                   // last usable place on the locked axis
  double angle_ = 0, last_angle_ = 0;  // radians
  bool ring_is_open_ = true;           // a gizmo's ring is seen well from above or below, else from its side
  std::string typed_;
};

}  // namespace lapedit
