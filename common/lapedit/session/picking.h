// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/mesh/visibility.h"
#include "lapedit/session/drag_motion.h"

// What a cursor on the screen means on a mesh.
namespace lapedit {

/// What of the surface a press means: what is under the cursor, or an edge right beside it. O(mesh).
std::optional<SurfaceHit> surface_at(const TriangleMesh& mesh, const Adjacency& adjacency, const Cursor& cursor);

/// The handle group whose mark on the screen the cursor is on, -1 if there is none. Marks show through the surface, so
/// what lies a little behind it can be taken hold of, but not what is on the far side.
/// @param hit    of the surface at the cursor
/// @param depth  how far a handle may be from the hit, model units
int group_at(const TriangleMesh& mesh, const std::vector<std::vector<int>>& groups,
             const std::optional<SurfaceHit>& hit, const Cursor& cursor, double depth);

/// Area-weighted normal of the surface at some vertices, of any length; zero if there is none.
Vector3 mean_normal(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices);

}  // namespace lapedit
