// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lapedit/deform/edit_settings.h"
#include "quality_edits.h"

namespace quality {

/// Prints how steady this library's poses are, as a Markdown table; what misses its target is bold. Lengths are in per
/// cent of the region's size, the diagonal of its box. The option is one of these:
///   --jumps       For each edit, the largest movement of a vertex in one of 50, 500 and 5,000 equal steps. All of 50
///   are
///                 solved, then ten parts of each of the three that differ most from the mean of their neighbours, so
///                 that the handle's own movement hides no jump, then ten parts of each of the three of these. Without
///                 a jump, the movement falls to a tenth each time; more than half misses the target.
///   --renumbered  For each edit, the largest distance of a vertex from itself where the mesh is numbered at random.
///   --symmetric   For each symmetric edit, the largest distance of a vertex from the mirror image of its partner.
///   --frames      For each edit, the distance of its last frame from the released pose, before the mouse rests, in per
///                 cent of the largest displacement: by the cells alone and with the correction.
/// @throws std::runtime_error if the mesh of a symmetric edit is not symmetric
void print_steadiness(const std::string& option, const std::vector<const NamedEdit*>& edits,
                      const lapedit::EditSettings& settings);

}  // namespace quality
