// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "lapedit/session/drag_session.h"
#include "surface_picture.h"

/// Shows region, handles, motion, gizmo and the preview of a press for one session. Only reads the session.
class Overlay {
 public:
  struct Brush {
    lapedit::Vector2 center;  ///< pixels
    double radius;
    bool takes;
  };

  struct Options {
    double width = 0, height = 0;                             ///< of the view, pixels
    double pixelRatio = 1;                                    ///< device pixels per pixel
    Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();  ///< of the layer
    std::optional<Brush> brush;
    Colours colours = Colours::Region;
  };

  /// Draws with the current OpenGL context, whose modelview matrix is that of the world. Changes OpenGL's state.
  /// O(size of the region).
  void draw(const lapedit::DragSession& session, const lapedit::Camera& view, const Options& options);

 private:
  void drawGizmoOf(const lapedit::DragSession& session, const lapedit::Camera& view);
  void drawPlane(const lapedit::DragSession& session);

  SurfacePicture surface_;
  std::optional<lapedit::Gizmo> gizmo_;     // before the motion
  std::optional<Eigen::AlignedBox3d> box_;  // of the mesh at the beginning
};
