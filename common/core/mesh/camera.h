// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A half-line; the direction may have any length but zero.
struct Ray {
  Vector3 origin = Vector3::Zero();
  Vector3 direction = Vector3::UnitZ();
};

/// The mapping from the mesh to a window. Pixels are counted from the upper left corner, y downwards, and may have
/// fractions.
class Camera {
 public:
  Camera();
  /// @param to_clip  projection times modelview times layer transform, as OpenGL has them: mesh coordinates to the cube
  ///                 [-1, 1]^3, near to far; perspective or orthographic
  Camera(const Eigen::Matrix4d& to_clip, double width, double height);

  /// Returns whether the map is finite and invertible, as the functions below require.
  bool valid() const { return valid_; }
  bool operator==(const Camera& other) const {
    return to_clip_ == other.to_clip_ && width_ == other.width_ && height_ == other.height_;
  }

  double height() const { return height_; }  ///< height of the window, pixels
  /// Returns the pixel at which a point is shown.
  Vector2 pixel(const Vector3& point) const;
  bool in_front(const Vector3& point) const;  ///< whether the point is in front of the viewer, not behind
  /// Returns the ray from the near plane through a pixel.
  Ray ray(const Vector2& pixel) const;
  /// Returns the point at a pixel in the plane through a point, parallel to the image.
  Vector3 beside(const Vector3& point, const Vector2& pixel) const;
  /// Returns the length of a pixel in the plane through a point, parallel to the image.
  double pixel_size(const Vector3& point) const;
  /// Returns the unit direction from a point to the viewer.
  Vector3 toward_viewer(const Vector3& point) const;

 private:
  Eigen::Matrix4d to_clip_, from_clip_;
  double width_ = 1, height_ = 1;
  bool valid_ = false;
};

}  // namespace lapedit
