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
  double degrees = 0;
  std::optional<Vector3> center;  ///< of rotation and scale; the group's centroid if absent
  double scale = 1;               ///< > 0
  /// Replaces all of the above: the upper three rows of a 4 x 4 matrix, applied to absolute coordinates.
  std::optional<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix;
};

/// The map that the transform stands for, taken a fraction of the way: 0 is exactly the identity, 1 exactly the
/// transform; in between rotations go by angle, scale and translation linearly. A matrix is split into rotation and
/// stretch (polar decomposition) for this, and moves about the group's centroid.
/// @throws EditError (BadParameter, NotFinite)
Affine resolve(const HandleTransform& transform, const Vector3& centroid, double fraction = 1);

}  // namespace lapedit
