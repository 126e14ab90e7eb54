// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/fit_report.h"
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
  double distance = 0;   ///< up to which pairs count fully, model units; 0: from the distances
};

const char* name(FitMode mode);
const char* name(FitAlign align);

/// @throws EditError (BadParameter)
void validate(const ScanFitSettings& settings);

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
  SimilarityMap alignment;  ///< model units
  FitReport report;
};

/// Returns the region of a fit: build_region() with the landmarks as its handle. Without landmarks it is all components
/// of the mesh, or the vertices given. @throws EditError as build_region()
Region fit_region(const TriangleMesh& mesh, const Adjacency& adjacency, const RegionSpec& spec,
                  const std::vector<int>& landmarks, int threads = 0);

/// Brings a template onto a scan.
///
/// After an alignment, eight lengths l from 0.4 to `detail` times the template's size S make as many stages. In each
/// round of a stage vertices are drawn to their partners (Correspondences) against the energy of TemplateEnergy, with
/// one factor per stage; the next round starts beyond the solution (over-relaxation). Anchors of the region keep their
/// positions, and need FitAlign::None.
/// @param mesh      the template, with at least the region's vertices finite
/// @param excluded  vertices of the region that are not drawn to the scan
/// @throws EditError (BadParameter, EmptyMesh, IllConditioned, Cancelled)
FitResult fit_template(const TriangleMesh& mesh, const Region& region, const std::vector<FitLandmark>& landmarks,
                       const std::vector<int>& excluded, const Scan& scan, const ScanFitSettings& settings,
                       const SolverOptions& options, const Progress& progress = {});

}  // namespace lapedit
