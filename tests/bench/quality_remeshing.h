// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "quality_scene.h"

namespace quality {

/// Makes each edit on its mesh, and on the same surface triangulated anew: every face into four; cuts by five planes;
/// a quarter of the edges flipped; half of the vertices removed beyond the middle of the mesh's longest side. Prints
/// how far apart the results are at the vertices that stay; what is above 5 % is bold. A new vertex belongs to a handle
/// or another set if both ends of its edge do.
void print_remeshed(const std::vector<const NamedEdit*>& edits, const std::vector<Method>& methods);

}  // namespace quality
