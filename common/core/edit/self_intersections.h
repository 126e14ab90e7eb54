// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "lapedit/edit/edit.h"

namespace lapedit {

/// Returns the number of pairs of faces that cross after an edit and did not before. Checks faces with a moved corner
/// against all others. Faces that are not finite cross nothing. Faces that share a corner cross if the opposite edge of
/// one passes through the other, and they are folded onto each other.
/// @param given  the mesh before the edit; vertices at the same position count as one
/// @param threads 0: as many as the machine has; the number does not depend on it
/// Cost: about that of one solution of a region of these faces.
int new_self_intersections(const TriangleMesh& given, const EditResult& result, int threads = 0);

/// Sets this number in the last report if at most `most_vertices` vertices moved. If memory is missing, the number
/// stays empty.
void count_self_intersections(const TriangleMesh& before, EditResult& result,
                              int most_vertices = std::numeric_limits<int>::max());

}  // namespace lapedit
