// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/edit_settings.h"

namespace lapedit {

/// How the weight of a handle's disc falls off from its middle to its boundary.
enum class Falloff {
  Even,    ///< not at all
  Sharp,   ///< at once: a peak
  Smooth,  ///< evenly: a hill
  Dome     ///< near the boundary: a rounded plateau
};

/// Settings of the user, which may change at any time.
struct DragSettings {
  double radius = 0;  ///< of a new region about the vertex clicked, along the surface, model units
  /// Greater than 0: a click on the surface sets the radius to that of the protrusion there, and to this one where
  /// there is none. Another radius, which a user sets, makes it 0.
  double first_radius = 0;
  double padding = 0.1;          ///< see RegionSpec
  double handle_fraction = 0.2;  ///< radius of the handle's disc over the region's; 0: the clicked vertex alone
  Falloff falloff = Falloff::Even;
  double connect_gap = 0;    ///< pieces nearer than this form one region, model units; 0: pieces stay separate
  bool pieces = true;        ///< see RegionSpec::pieces
  double brush_pixels = 20;  ///< radius of the brush on the screen
  EditSettings edit;
};

/// How clicks on the surface define a handle.
enum class HandleMode {
  Vertex,  ///< the vertex clicked, and those within the handle radius
  Curve    ///< the vertices of shortest paths from click to click
};

/// Largest fraction of a region's radius: the remainder has to follow the handle.
constexpr double kLargestHandleFraction = 0.9;

/// Returns the radius of the disc of a click.
inline double disc_radius(const DragSettings& settings) {
  return settings.handle_fraction * settings.radius;
}

/// Returns the initial settings of a session with a mesh.
DragSettings settings_for(const TriangleMesh& mesh);

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const DragSettings& settings);

}  // namespace lapedit
