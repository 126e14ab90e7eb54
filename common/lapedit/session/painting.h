// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/session/selection.h"

namespace lapedit {

/// The target of the brush.
enum class BrushTarget { Region, Handle, Anchors };

/// A change of all that is painted of a target.
enum class PaintChange {
  Invert,  ///< of the mesh; of a handle within the region
  Blur,    ///< a smoother outline
  Clear
};

/// A stroke of the brush over some vertices, ascending: adds to what is painted of a target, or takes away. Handles
/// stay in a region; fixed vertices are those of later regions, too.
Choice brushed(const Surface& surface, const Selection& selection, BrushTarget target, const std::vector<int>& patch,
               bool add);
/// Makes these vertices of the region anchors, with its rim; in any order. Those outside the region, or all if there is
/// none, are kept for later regions.
Choice with_anchors(const Surface& surface, const Selection& selection, std::vector<int> vertices);
/// Makes these vertices, in any order, the active handle.
Choice with_handle(const Surface& surface, const Selection& selection, std::vector<int> vertices);
Choice with_painted(const Surface& surface, const Selection& selection, BrushTarget target, PaintChange change);

}  // namespace lapedit
