// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// How the vertices of one handle group move: rotation and uniform scale about a centre, then a translation; or any
/// affine map. Lengths in model units.
struct HandleTransform {
  Vector3 translation = Vector3::Zero();
  Vector3 axis = Vector3::UnitZ();  ///< any length but zero
  double degrees = 0;               ///< 270 and -90 lead to the same place along different paths
  std::optional<Vector3> center;    ///< of rotation and scale; the group's centroid if absent
  double scale = 1;                 ///< > 0
  /// Replaces all of the above: the upper three rows of a 4 x 4 matrix, applied to absolute coordinates.
  std::optional<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix;
};

/// Where the vertices of one handle group go, and along which path: see MotionPath. Absolute coordinates.
struct HandleMotion {
  /// A rotation that counts its turns.
  struct Turn {
    Vector3 axis = Vector3::UnitZ();  ///< unit
    double degrees = 0;
    std::optional<Vector3> center;  ///< the group goes in a circle about it; absent: it rotates about its own centroid
  };

  Affine map = Affine::Identity();
  std::optional<Turn> turn;  ///< the rotation in `map`; absent: at most 180 degrees
  /// Of each vertex of the group, in the order of their numbers, in place of `map`; no rows: `map` counts.
  Points targets = Points(0, 3);
  double part = 1;  ///< how far along the path, 0 to 1

  HandleMotion() = default;
  HandleMotion(const Affine& to) : map(to) {}  // NOLINT(google-explicit-constructor): an affine map is a motion
};

/// The motion that the transform stands for, all of the way.
/// @param centroid  of the group at rest
/// @throws EditError (BadParameter, NotFinite)
HandleMotion resolve(const HandleTransform& transform, const Vector3& centroid);

}  // namespace lapedit
