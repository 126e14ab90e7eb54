// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/session/selection.h"

namespace lapedit {

/// The target of the brush.
enum class BrushTarget { Region, Handle, Anchors };

/// A change of all painted vertices of a target.
enum class PaintChange {
  Invert,  ///< of the mesh; of a handle within the region
  Blur,    ///< a smoother outline
  Clear
};

/// Returns the selection after a stroke of the brush over some vertices, ascending, which adds them to a target or
/// removes them. Handles stay in a region; fixed vertices hold in later regions, too.
Choice brushed(const Surface& surface, const Selection& selection, BrushTarget target, const std::vector<int>& patch,
               bool add);
/// Makes the given vertices, in any order, fixed.
Choice with_anchors(const Surface& surface, const Selection& selection, std::vector<int> vertices);
/// Makes these vertices, in any order, the active handle.
Choice with_handle(const Surface& surface, const Selection& selection, std::vector<int> vertices);
Choice with_painted(const Surface& surface, const Selection& selection, BrushTarget target, PaintChange change);

}  // namespace lapedit
