// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "lapedit/base/types.h"

namespace lapedit {

/// Pairs of points whose targets seem to be exchanged, such as left and right.
struct ExchangedTargets {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< the lower number first, ascending; empty: none
  /// RMS distance of all targets from the rigid motion with scale that fits best: as given, and with those targets
  /// exchanged; model units.
  double given = 0, exchanged = 0;
};

/// Finds the exchange of targets after which a rigid motion with scale fits far better: to less than a third of the
/// distance, and to less than 0.15 of the targets' spread. Single pairs are tried, pairs after pairs, and all pairs
/// that mirror each other at a plane between two points. Targets that differ from a rigid motion for other reasons are
/// not found, since no exchange explains them, nor exchanges that a rotation explains, as of three points.
/// Returns no pairs for fewer than 4 points or more than 60. Cost: some milliseconds for 20 points.
ExchangedTargets find_exchanged_targets(const std::vector<Vector3>& points, const std::vector<Vector3>& targets);

}  // namespace lapedit
