// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/edit_settings.h"

namespace lapedit {

/// What the user can set; all of it may change at any time.
struct DragSettings {
  double radius = 0;         ///< of a new region, along the surface, model units; 0: a tenth of the box's diagonal
  double padding = 0.1;      ///< see RegionSpec
  double handle_radius = 0;  ///< vertices within it of the one clicked are picked together; 0: that one alone
  double brush_pixels = 20;  ///< radius of the brush on the screen
  EditSettings edit;
};

/// What clicks on the surface make a handle of.
enum class HandleMode {
  Vertex,  ///< the vertex clicked, and those within the handle radius
  Curve    ///< the vertices of shortest paths from click to click
};

/// The settings that a session with a mesh begins with.
DragSettings settings_for(const TriangleMesh& mesh);

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const DragSettings& settings);

}  // namespace lapedit
