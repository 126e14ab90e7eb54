// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/session/selection.h"

namespace lapedit {

/// Returns the weight of each handle vertex in the displacement of one point of a curve: 1 at the point, 0 from the
/// next points on, smooth along the curve. Towards an end the curve swings freely; between points it keeps its
/// direction at them. Equal displacements of all points translate the curve.
/// @param group  the handle's vertices, ascending. @param point  number among curve.points
std::vector<double> bend_weights(const TriangleMesh& mesh, const std::vector<int>& group, const HandleCurve& curve,
                                 int point);

/// Returns the point of a curve near the mirror image of another point, -1 if there is none.
int mirrored_point(const TriangleMesh& mesh, const HandleCurve& curve, int point, const Affine& mirror);

}  // namespace lapedit
