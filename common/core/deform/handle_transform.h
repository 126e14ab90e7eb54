// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// The transform of a handle group: rotation and uniform scale about a centre, then a translation; or any affine map.
/// Lengths are in model units.
struct HandleTransform {
  Vector3 translation = Vector3::Zero();
  Vector3 axis = Vector3::UnitZ();  ///< any length but zero
  double degrees = 0;               ///< 270 and -90 lead to the same position along different paths
  std::optional<Vector3> center;    ///< of rotation and scale; the group's centroid if absent
  double scale = 1;                 ///< > 0
  /// Replaces all of the above: the upper three rows of a 4 x 4 matrix, applied to absolute coordinates.
  std::optional<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix;
};

/// The motion of a handle group to its target, along the path of MotionPath. Coordinates are absolute.
struct HandleMotion {
  /// A rotation that counts revolutions.
  struct Rotation {
    Vector3 axis = Vector3::UnitZ();  ///< unit
    double degrees = 0;
    std::optional<Vector3> center;  ///< centre of the circular path; absent: the group rotates about its own centroid
  };

  Affine map = Affine::Identity();
  std::optional<Rotation> rotation;  ///< the rotation in `map`; absent: at most 180 degrees
  /// Targets of the group's vertices, ascending by vertex number; they replace `map`. No rows: `map` is used.
  Points targets = Points(0, 3);
  double fraction = 1;  ///< of the path, 0 to 1

  HandleMotion() = default;
  HandleMotion(const Affine& to) : map(to) {}  // NOLINT(google-explicit-constructor): an affine map is a motion
};

/// Returns whether a linear map mirrors; one that flattens, up to rounding, does not.
bool mirrors(const Matrix3& linear);

/// Returns the motion that the transform describes, with `fraction` 1.
/// @param centroid  of the group at rest
/// @throws EditError (BadParameter, NotFinite)
HandleMotion resolve(const HandleTransform& transform, const Vector3& centroid);

/// A map x -> L x + t, stored as L - I and t relative to a local origin, so that translations of meshes far from the
/// origin are exact.
struct LocalMotion {
  Matrix3 linear = Matrix3::Zero();       ///< L - I
  Vector3 translation = Vector3::Zero();  ///< displacement of the local origin

  /// Returns an affine map relative to an origin.
  static LocalMotion of(const Affine& map, const Vector3& origin);
  Vector3 displacement(const Vector3& local) const { return linear * local + translation; }
  Matrix3 rotation() const;  ///< of the map; the identity for a reflection
  /// Returns whether the map is exactly the identity.
  bool none() const { return linear.isZero(0) && translation.isZero(0); }
};

/// The path of a handle group from rest to its target. The rotation angle, scale and shear grow evenly. The centroid
/// moves in a circle if the rotation has a given centre; along the arc of a screw motion if the rotation has none and
/// at most 180 degrees; and straight otherwise. The path of a fraction of an edit is that fraction of the path. The
/// bits are the same on every processor.
class MotionPath {
 public:
  MotionPath() = default;
  /// @param to      the whole motion; HandleMotion::fraction and targets are ignored
  /// @param origin  of local coordinates
  /// @param centre  centroid of the group at rest, local
  MotionPath(const HandleMotion& to, const Vector3& origin, const Vector3& centre);

  /// Returns the motion at a fraction of the path; exactly the identity at 0 and the whole motion at 1.
  LocalMotion at(double fraction) const;

  /// Returns the length of the path, in which 30 degrees of rotation, a displacement of `unit`, or a stretch of a
  /// quarter count as 1.
  double length(double unit) const;

  Vector3 turn() const { return degrees_ * axis_; }  ///< the whole rotation in degrees, with its revolutions

 private:
  LocalMotion whole_;
  Vector3 centre_ = Vector3::Zero(), displacement_ = Vector3::Zero(), axis_ = Vector3::UnitZ();
  Vector3 lever_ = Vector3::Zero();  // from the centre of the rotation to the centroid
  Matrix3 stretch_ = Matrix3::Identity();
  double degrees_ = 0, arc_ = 0;
  double scale_ = 1;  // of the lever
};

}  // namespace lapedit
