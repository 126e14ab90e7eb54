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

}  // namespace lapedit
