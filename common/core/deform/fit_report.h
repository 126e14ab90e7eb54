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

/// RMS distances of what overlaps after the alignment, of some samples: for comparison with each other.
struct Orientations {
  bool stayed = false;           ///< the template kept its place
  double chosen = 0;             ///< 0: not searched
  std::optional<double> second;  ///< the best other one
  double mirrored = 0;           ///< that of the template's mirror image
};

/// The landmark of a fit that is farthest from its target.
struct OddLandmark {
  int vertex = -1;      ///< of the mesh; -1: none
  double distance = 0;  ///< from the target
  double others = 0;    ///< RMS of the other landmarks
  double to_scan = 0;   ///< distance of its target from the scan
};

/// The figures of the fit of a template to a scan. Lengths are in model units.
struct FitReport {
  std::string mode, scan;
  std::string aligned;  ///< kind of alignment: "similarity", "rigid" or "none"
  FitDistances to_scan, from_scan;
  double scale = 1;      ///< of the alignment
  double alignment = 0;  ///< RMS distance of what overlaps after the alignment
  Orientations orientations;
  /// Whether landmarks aligned it: then their RMS distance to the targets, over that of the targets to their mean.
  std::optional<double> by_landmarks;
  double uncovered = 0;        ///< RMS distance of the whole scan from the template
  double largest_stretch = 1;  ///< of its triangles, but for half a percent of them, over the median
  OddLandmark odd;
  int hidden = 0;                 ///< number of pieces that the scan does not show, which follow the surface around
  bool reversed_normals = false;  ///< the scan's normals point inwards
  double opposed = 0;             ///< fraction of the template where the scan's normals point the other way
  double size = 1;                ///< of the scan
  double size_ratio = 1;          ///< size of the scan over that of the template
  int landmarks = 0, stages = 0, rounds = 0;
};

}  // namespace lapedit
