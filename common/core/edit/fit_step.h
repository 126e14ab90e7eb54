// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lapedit/edit/edit_step.h"
#include "lapedit/edit/step_solver.h"
#include "lapedit/mesh/adjacency.h"

namespace lapedit {

/// Reads a scan by the name that an edit gives: a file, or in MeshLab a layer. @throws EditError
using ScanReader = std::function<ScanData(const FitStep& fit)>;

/// Returns the edit with the scans of its fits. @throws EditError as the reader does, and as Scan
Edit with_scans(Edit edit, const ScanReader& reader);

/// The result of a step with a fit.
struct FittedStep {
  std::vector<int> vertices;  ///< ascending mesh vertex numbers
  Points positions;           ///< as computed
  EditReport report;
};

/// Fits the region of a step to its scan, or goes half of the way to the mirror image. The result has the same bits for
/// any number of threads.
/// @param given  with sorted groups: landmarks with targets, or none. Without landmarks its region is all components of
///        the mesh, or the vertices given
/// @throws EditError (BadParameter) for a step without its scan, with groups that have no targets, with a scan and a
///         mirror plane, or without either for a mesh that is not symmetric; and as build_region() and fit_template()
FittedStep fit_step(const TriangleMesh& mesh, const Adjacency& adjacency, const EditStep& given,
                    const SolverOptions& options);

/// Returns the positions at a fraction of the displacements, rounded. @throws EditError (NotFinite)
Points positions_at(const FittedStep& fitted, const TriangleMesh& mesh, double fraction, StoredScalar scalar);

}  // namespace lapedit
