// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/edit_settings.h"

namespace lapedit {

/// Settings of the user, which may change at any time.
struct DragSettings {
  double radius = 0;             ///< of a new region about the vertex clicked, along the surface, model units
  double padding = 0.1;          ///< see RegionSpec
  double handle_fraction = 0.2;  ///< radius of the handle's disc over the radius; 0: the clicked vertex alone
  double softness = 0;           ///< fraction of the disc's radius over which the handle's weight falls off, 0 to 1
  double connect_gap = 0;        ///< pieces nearer than this form one region, model units; 0: pieces stay separate
  double brush_pixels = 20;      ///< radius of the brush on the screen
  EditSettings edit;
};

/// How clicks on the surface define a handle.
enum class HandleMode {
  Vertex,  ///< the vertex clicked, and those within the handle radius
  Curve    ///< the vertices of shortest paths from click to click
};

/// Largest fraction of a region's radius: the remainder has to follow the handle.
constexpr double kLargestHandleFraction = 0.9;

/// Returns the initial settings of a session with a mesh.
DragSettings settings_for(const TriangleMesh& mesh);

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const DragSettings& settings);

}  // namespace lapedit
