// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/edit_settings.h"

namespace lapedit {

/// What the user can set; all of it may change at any time.
struct DragSettings {
  double radius = 0;          ///< of a new region about the vertex clicked, along the surface, model units
  double padding = 0.1;       ///< see RegionSpec
  double handle_share = 0.2;  ///< of the radius: how far a handle's disc goes; 0: the vertex clicked alone
  double softness = 0;        ///< of the disc's radius: over how much of it the handle's weight falls off, 0 to 1
  double connect_gap = 0;     ///< pieces nearer than this are one region, model units; 0: pieces are left apart
  double brush_pixels = 20;   ///< radius of the brush on the screen
  EditSettings edit;
};

/// What clicks on the surface make a handle of.
enum class HandleMode {
  Vertex,  ///< the vertex clicked, and those within the handle radius
  Curve    ///< the vertices of shortest paths from click to click
};

/// Of a region's radius: the rest is to follow the handle.
constexpr double kLargestHandleShare = 0.9;

/// The settings that a session with a mesh begins with.
DragSettings settings_for(const TriangleMesh& mesh);

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const DragSettings& settings);

}  // namespace lapedit
