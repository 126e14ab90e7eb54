// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace lapedit {

/// Distances of a template and a scan in one direction, of pairs that found each other, model units.
struct FitDistances {
  double matched = 0;                                 ///< fraction that found a partner
  double rms = 0, median = 0, most = 0, largest = 0;  ///< `most`: the 95 % quantile
};

/// The figures of the fit of a template to a scan. Lengths are in model units.
struct FitReport {
  std::string mode, scan;
  std::string aligned;  ///< kind of alignment: "similarity", "rigid" or "none"
  FitDistances to_scan, from_scan;
  double scale = 1;              ///< of the alignment
  double alignment = 0;          ///< RMS distance of the nearest 80 % after the alignment
  std::optional<double> second;  ///< the same for the best other orientation
  /// Whether landmarks aligned it: then their RMS distance to the targets, over that of the targets to their mean.
  std::optional<double> by_landmarks;
  bool reversed_normals = false;  ///< the scan's normals point inwards
  double opposed = 0;             ///< fraction of the template where the scan's normals point the other way
  double size = 1;                ///< of the scan
  double size_ratio = 1;          ///< size of the scan over that of the template
  int landmarks = 0, stages = 0, rounds = 0;
};

}  // namespace lapedit
