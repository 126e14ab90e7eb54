// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lapedit/base/similarity.h"
#include "lapedit/deform/edit_report.h"
#include "lapedit/fit/scan.h"

namespace lapedit {

/// What is allowed when a template is aligned with its scan before the fit.
enum class FitAlign {
  Similarity,  ///< translation, rotation and scale
  Rigid,       ///< translation and rotation
  None         ///< the template is in place
};

struct Alignment {
  SimilarityMap map;    ///< of the template of size 1
  double residual = 0;  ///< RMS distance of the pairs that overlap, both ways; the scan's size is 1
  Orientations orientations;
  bool by_landmarks = false;
};

/// Aligns a template with a scan: by the landmarks if there are three that are not on a line, otherwise from several
/// starts by trimmed closest points in both directions. A template that already lies well keeps its place.
/// @param from  the template, of size 1 about its centroid. @param in_place  takes it to the scan's coordinates
/// @param landmarks, targets  of each its position on the template and on the scan
/// @throws EditError (Cancelled). Cost: some tenths of a second.
Alignment align(const SurfaceIndex& from, const Scan& scan, const SimilarityMap& in_place, const Points& landmarks,
                const Points& targets, FitAlign allowed, ThreadPool& pool);

}  // namespace lapedit
