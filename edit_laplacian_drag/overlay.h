// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/session/drag_session.h"

/// Shows region, handles and motion of one session in the colours of the paper's Figure 3. Reads, and changes nothing.
class Overlay {
 public:
  struct Brush {
    lapedit::Vector2 center;  ///< pixels
    double radius;
    bool takes;
  };

  /// Draws with the present OpenGL context, into the layer's coordinates: its transform is in the modelview matrix.
  /// Leaves the state of OpenGL as it was. O(size of the region).
  /// @param pixelRatio  device pixels per pixel
  void draw(const lapedit::DragSession& session, const lapedit::Camera& view, const std::optional<Brush>& brush,
            double width, double height, double pixelRatio);

 private:
  void drawRegion(const lapedit::DragSession& session, double handleSize, double pixelRatio);
  void sort(const lapedit::Region& region);

  // Of the session's region of this serial.
  int sorted_ = -1;
  std::vector<unsigned> handles_, anchors_;
  std::vector<unsigned char> colors_;  // RGBA per region vertex
};
