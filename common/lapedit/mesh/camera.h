// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/mesh/triangle_mesh.h"

namespace lapedit {

/// A half-line; the direction may have any length but zero.
struct Ray {
  Vector3 origin = Vector3::Zero();
  Vector3 direction = Vector3::UnitZ();
};

/// How a window shows the mesh. Pixels are counted from the upper left corner, y downwards, and may have fractions.
class Camera {
 public:
  Camera();
  /// @param to_clip  projection times modelview times layer transform, as OpenGL has them: mesh coordinates to the cube
  ///                 [-1, 1]^3, near to far; perspective or orthographic
  Camera(const Eigen::Matrix4d& to_clip, double width, double height);

  /// Whether the map can be inverted and is finite; nothing below may be asked otherwise.
  bool valid() const { return valid_; }
  bool operator==(const Camera& other) const {
    return to_clip_ == other.to_clip_ && width_ == other.width_ && height_ == other.height_;
  }

  Vector2 pixel(const Vector3& point) const;
  bool in_front(const Vector3& point) const;  ///< of the near plane's camera, not behind it
  /// From the near plane into the picture, through a pixel.
  Ray ray(const Vector2& pixel) const;
  /// The point behind a pixel that lies in the plane through a point, parallel to the picture.
  Vector3 beside(const Vector3& point, const Vector2& pixel) const;
  /// Length of a pixel in the plane through a point, parallel to the picture.
  double pixel_size(const Vector3& point) const;
  /// Direction, of length 1, from a point towards the viewer.
  Vector3 toward_viewer(const Vector3& point) const;

 private:
  Eigen::Matrix4d to_clip_, from_clip_;
  double width_ = 1, height_ = 1;
  bool valid_ = false;
};

}  // namespace lapedit
