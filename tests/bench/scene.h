// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "peers.h"

namespace speed {

/// Makes a disc of radius 1 with this number of vertices, all of them in the region, and a handle of one vertex in its
/// middle: irregular in position and valence, with smooth bumps and ripples a few edges long; numbered in coherent
/// strips in random order.
quality::Problem make_scene(int vertices);

/// Returns the handle's motion in a frame: never the same twice.
lapedit::Affine handle_move(int frame);

}  // namespace speed
