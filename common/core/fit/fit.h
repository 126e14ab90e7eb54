// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/deform/edit_report.h"
#include "lapedit/fit/align.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// What a fit may do to the shape of a template.
enum class FitMode {
  Shape,  ///< another shape of the same kind: differential coordinates rotate and scale as a whole
  Pose    ///< the same body in another pose: differential coordinates rotate locally
};

struct ScanFitSettings {
  FitMode mode = FitMode::Shape;
  /// Empty: FitAlign::None for a region with anchors, else similarity for FitMode::Shape and rigid for FitMode::Pose.
  std::optional<FitAlign> align = {};
  double detail = 0.03;  ///< length of the last stage over the template's size, 0.003 to 0.4
  /// Of the landmarks, model units: their targets are met about as exactly; none: 0.5 % of the scan's size.
  std::optional<double> accuracy = {};
  /// Draws the template's border to that of the scan: both end at the same lines. Without it a fit does so only if the
  /// template slid along the scan, and both then cover each other.
  bool borders = false;
  double distance = 0;  ///< up to which pairs count fully, model units; 0: from the distances
};

inline const char* name(FitMode mode) {
  return mode == FitMode::Shape ? "shape" : "pose";
}
inline const char* name(FitAlign align) {
  return align == FitAlign::Similarity ? "similarity" : align == FitAlign::Rigid ? "rigid" : "none";
}

/// A vertex of the region and its position on the scan.
struct FitLandmark {
  int vertex;         ///< of the region
  Vector3 target;     ///< model units
  double weight = 1;  ///< 0 to 1
  double slide = 1;   ///< factor of the displacement across the scan's normal, 0 (slides freely) to 1
};

struct FitResult {
  Points positions;  ///< of the region's vertices, model units
  std::vector<Matrix3> rotations;
  FitReport report;
};

struct FitProblem {
  const TriangleMesh& mesh;  ///< the template, with at least the region's vertices finite
  const Region& region;      ///< of it, with or without anchors
  const Scan& scan;
  ScanFitSettings settings = {};
  std::vector<FitLandmark> landmarks = {};
  std::vector<int> excluded = {};  ///< vertices of the region that are not drawn to the scan
  int threads = 0;                 ///< 0: number of processors
};

/// Brings a template onto a scan.
///
/// After an alignment, nine lengths l from 0.4 to `detail` times the template's size S make as many stages. In each
/// round of a stage vertices are drawn to their partners (Correspondences) against the energy of TemplateEnergy, with
/// one factor per stage and with momentum. Anchors of the region keep their positions, and need FitAlign::None. The
/// result has the same bits for any number of threads, on every processor.
/// @throws EditError (BadParameter, EmptyMesh, IllConditioned, Cancelled)
FitResult fit_template(const FitProblem& problem, const Progress& progress = {});

}  // namespace lapedit
