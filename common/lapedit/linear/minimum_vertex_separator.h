// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/linear/dissection_parts.h"

namespace lapedit::dissection {

/// Makes a separator smaller, or a division more even: takes the smallest one among `layers` layers of vertices on each
/// side, by a largest flow (Dinic 1970). Takes time in proportion to the band's entries, times the few phases that a
/// flow needs in practice; allocates what `scratch` does not have yet.
/// @param scratch  its `side` is the division, per vertex of the piece; changed where that makes its score better
/// @param counts   vertices per side, likewise
void improve_separator(const Piece& piece, Scratch& scratch, Counts& counts, int layers);

}  // namespace lapedit::dissection
