// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/edit/edit.h"

namespace lapedit::host {

/// How many pairs of faces intersect after an edit and did not before, by vcglib's own test, which MeshLab's filter
/// *Select Self Intersecting Faces* uses: of faces that share an edge never, of those that share a corner where one is
/// pierced by the edge opposite to it. Looks at faces with a moved corner, and at all that they could meet. Faces
/// without area, or not finite, meet nothing.
/// @param before  the mesh that the result is an edit of
/// @param threads 0: as many as the machine has; the number does not depend on it
/// Cost: about that of one solution of a region of these faces.
int new_self_intersections(const TriangleMesh& before, const EditResult& result, int threads = 0);

/// Puts that number into the last report, where there are at most so many vertices. What goes wrong leaves it out.
void count_self_intersections(const TriangleMesh& before, EditResult& result, int most_vertices);

}  // namespace lapedit::host
