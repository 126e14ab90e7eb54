// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/mesh/visibility.h"
#include "lapedit/session/drag_motion.h"
#include "lapedit/session/selection.h"

// Finds the handle or the point of a curve under a cursor.
namespace lapedit {

/// Returns the handle group whose mark is under the cursor, -1 if there is none. Marks show through the surface, so a
/// mark slightly behind it can be picked, but not one on the far side.
/// @param hit    of the surface at the cursor
/// @param depth  how far a handle may be from the hit, model units
int group_at(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups,
             const std::optional<SurfaceHit>& hit, const Cursor& cursor, double depth);

/// Returns the point of a bendable curve that a press at the cursor moves, -1 if there is none.
int curve_point_at(const TriangleMesh& mesh, const HandleCurve& curve, const Cursor& cursor);

}  // namespace lapedit
