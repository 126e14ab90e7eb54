// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/differential_operator.h"
#include "lapedit/linear/sparse_cholesky.h"

namespace lapedit {

/// How an edit is solved, whatever its region and handles.
struct EditSettings {
  LaplacianKind laplacian = LaplacianKind::Umbrella;
  int order = 1;  ///< 1 to 3
  DetailRotation rotation = DetailRotation::SmoothSurface;
  int iterations =
      1;  ///< rotation passes, 1 to 100; stops early once a pass moves nothing by 1e-4 of the region's radius
  double normal_radius = 0;  ///< r of the smoothing, model units; 0: automatic
  /// Against equations of weight 1 per differential coordinate. At 1 the handle of a small region stays 1 % behind and
  /// the rim moves by up to 0.9 % of the handle's way; at 10 both are below 0.02 % and the shape is the same to the
  /// eye.
  double handle_weight = 10;
  double anchor_weight = 10;  ///< an anchor's own weight is this times d / d_max
  CholeskyBackend backend = CholeskyBackend::Automatic;
  int threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
};

/// @throws EditError (BadParameter) naming the setting, its value and its range
void validate(const EditSettings& settings);

}  // namespace lapedit
