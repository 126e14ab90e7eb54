// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/base/types.h"

namespace lapedit {

/// How rotations are fitted to a pose.
struct FitSettings {
  /// Factor of the extrapolation: rotations are fitted to x + momentum (x - x_previous).
  double momentum;
  /// Number of averagings of the covariances over neighbouring cells.
  int averagings;
};

/// To a pose of the vertices. The momentum saves more than half of the passes.
constexpr FitSettings kVertexFit = {0.9, 4};
/// To a pose of the cells. Found by measuring stretch, folds and the tilt of details over some twenty edits
/// (tests/scripts/quality.sh).
constexpr FitSettings kCellFit = {0.5, 1};

/// A pose extrapolated from the last two. Empty before the first.
struct Extrapolation {
  Points previous, ahead;  ///< size() x 3: displacement of the last pass, and the extrapolated one

  /// @param pass  number of poses before this one
  const Points& operator()(const Points& displacement, int pass) {
    ahead = displacement;
    if (pass > 0) {
      ahead += kVertexFit.momentum * (displacement - previous);
    }
    previous = displacement;
    return ahead;
  }
};

}  // namespace lapedit
