// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/camera.h"

namespace lapedit {

/// The position of the mouse, with the view. Pixels as in Camera.
struct Cursor {
  Camera view;
  Vector2 pixel = Vector2::Zero();
  bool snap = false;                             ///< amounts change in steps
  std::optional<Vector3> target = std::nullopt;  ///< where a translation takes the grabbed point
};

enum class MotionKind { Translate, Rotate, Scale };
enum class AxisLock { None, X, Y, Z, Normal, Gizmo };

/// Describes a motion: "Moving by 0.5 along Y", "Turning by 30 degrees".
std::string motion_text(const HandleTransform& motion);

/// Converts mouse movements and typed numbers to the transform of a handle group.
///
/// Translation follows the cursor in the plane parallel to the image, or along the locked axis to the point nearest to
/// the cursor's ray. Rotation is about the line of sight or the locked axis, by the angle of the cursor about the
/// centre on the screen, or along a gizmo's ring. Scale is the ratio of the cursor's distances from the centre on the
/// screen; with a locked axis it is along that axis alone. With Cursor::snap angles go in steps of 15 degrees, factors
/// in steps of 0.1, and lengths in steps of 1, 2 or 5 times a power of ten that show as 10 to 25 pixels. A typed number
/// replaces the amount of the mouse; a typed angle counts in the direction of the mouse; 100 % are the factor 1, a
/// revolution or the region's radius. With Cursor::target a translation takes the grabbed point there, with a lock as
/// near as the axis goes. The view may change during a motion.
class DragMotion {
 public:
  /// @param grab      the point of the surface that is to stay under the cursor
  /// @param centroid  of the handle group: centre of rotation and scale without a pivot
  /// @param normal    of the surface at the handle, any length; zero if it has none
  /// @param pivot     another centre of rotation and scale, which transform() then names
  /// @param radius    of the region
  DragMotion(MotionKind kind, const Vector3& grab, const Vector3& centroid, const Vector3& normal, const Cursor& cursor,
             const std::optional<Vector3>& pivot = std::nullopt, double radius = 1);

  /// Locks the motion to an axis of a gizmo, of any length but zero.
  void hold(const Vector3& axis);

  MotionKind kind() const { return kind_; }
  AxisLock lock() const { return lock_; }
  /// Locks an axis; the same lock again releases it. @return false if the axis does not exist, as for a surface without
  /// a normal
  bool toggle_lock(AxisLock lock);
  /// Returns the unit direction of the locked axis.
  std::optional<Vector3> axis() const;
  const Vector3& grab() const { return grab_; }
  /// Returns the centre of rotation and scale.
  const Vector3& center() const { return center_; }
  /// Returns the unit direction from the centre to where the mouse started a rotation, orthogonal to the axis (zero if
  /// parallel to it).
  const Vector3& arm() const { return arm_; }

  void move(const Cursor& cursor);
  /// Adds 0-9 . % or - (which changes the sign). @return false if that gives no number
  bool type(char character);

  /// Returns a transform that can always be resolved; the identity where the view gives no number.
  HandleTransform transform() const;
  bool moves() const;        ///< whether the transform differs from the first one
  double step() const;       ///< amounts are multiples of it: degrees, model units or a factor; 0: no steps
  std::string text() const;  ///< "Moving by 0.5 along Y"

 private:
  Vector3 translation_by_mouse() const;
  double along_axis(const Cursor& cursor, double otherwise) const;
  HandleTransform transform_by_mouse() const;
  std::optional<double> amount() const;
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
  bool names_center_;  // the centre is not the default one of a transform
  double radius_;
  Vector3 gizmo_axis_ = Vector3::Zero();
  Vector3 arm_ = Vector3::Zero();
  Vector3 sight_;          // from the centre towards the viewer, when the motion began
  Cursor start_, cursor_;  // start_ has the view of cursor_
  // Motion before the last change of the view.
  Vector3 translation_before_ = Vector3::Zero();
  double factor_before_ = 1;
  double along_ = 0;                   // last defined position on the locked axis
  double angle_ = 0, last_angle_ = 0;  // radians
  std::string typed_;
};

}  // namespace lapedit
