// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// Returns b - p, the displacement from the rest pose p to the surface b without details, which setting `detail`
/// scales. b minimises
///
///     |M^k x - M^(k-1) h delta|^2 + sum_i w_i^2 |x_i - p_i|^2,
///
/// the bending energy through anchors and handles. h is 0 inside the region, so that a plate becomes flat and a sphere
/// round. Across the anchor band, whose details stay, it rises to 1; it is 1 at borders of the mesh, which would
/// contract otherwise. Stretching has no cost, since a membrane would flatten what is round.
///
/// Solved by conjugate gradients with the system's factor as preconditioner. The bits are the same for any number of
/// threads. Cost: 10 to 60 solves.
/// @return size() x 3. @throws EditError (BadParameter) if a component of the region has no anchor; (Cancelled)
Points fair_displacement(const LaplacianSystem& system);

}  // namespace lapedit
