// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lapedit/base/progress.h"
#include "lapedit/deform/edit_report.h"
#include "lapedit/deform/edit_settings.h"
#include "lapedit/deform/handle_transform.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// @throws EditError (NotFinite) with a message for the user unless all positions of a result are finite
void require_finite_result(const Points& positions);

/// Solves for poses of one region with its handles (paper, sections 3 to 5).
///
/// Minimises |M^k x - M^(k-1) R delta|^2 + sum_i w_i^2 |x_i - c_i|^2 over the region's vertices, where k is the order,
/// delta = M p the differential coordinates of the rest pose p, and R the detail rotations. With k = 1 this is the
/// paper's system. For k > 1 coordinates are rotated before M^(k-1) is applied; where R is constant this is the paper's
/// formula. The unknowns are displacements from the rest pose, so vertices that do not move keep their bits. A
/// constructed object is always usable; other handles, anchors or settings need a new one, which can reuse the old
/// one's factor.
class PoseSolver {
 public:
  /// @param mesh      rest pose; not kept after construction
  /// @param previous  a solver that is no longer needed, or null: parts that still fit, above all the factor, are
  ///                  reused, so that another small handle in the same region with the same anchors is ready in a
  ///                  fraction of the time. The result has the same bits in both cases
  /// Cost: the operator, one sparse Cholesky factorisation, and the tables of the smoothing; solve() does none of this.
  /// @throws EditError (BadParameter, IllConditioned, Cancelled)
  PoseSolver(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest, const EditSettings& settings,
             const Progress& progress = {}, std::unique_ptr<PoseSolver> previous = nullptr);
  ~PoseSolver();

  const LaplacianSystem& system() const;
  /// Returns the solver of the system, for others that never compute at the same time as this object.
  RefinedSolver& solver();
  const std::string& taken_over() const;  ///< see EditReport::taken_over

  /// Returns the positions of the region's vertices after its handle groups have moved.
  ///
  /// A component without anchors is first moved by the mean of its groups' maps, so that it follows a single group
  /// exactly; one with anchors by the map given for them.
  /// @param handles  one motion per handle group; an affine map converts to a motion
  /// @param anchors  motion of the anchors; in an edit the identity
  /// @param start    with DetailRotation::LocalGlobal the rotations of the first pass, one per vertex, relative to the
  ///                 rigid motion of its component; null: the identity
  /// @return         size() x 3, model units, row i belongs to region().mesh_vertex[i]; valid until the next call
  /// @throws EditError (NotFinite) if a map or the result is not finite; (Cancelled); the editor stays usable
  /// @param go_on    called from time to time with the fraction 0; returning false cancels
  /// Cost: one unrotated solve, unless rotations are estimated from a fall-off, and one solve per rotation pass, each
  /// with some steps of refinement. Nothing is allocated after the first call.
  const Points& solve(const std::vector<HandleMotion>& handles, const Affine& anchors = Affine::Identity(),
                      const std::vector<Matrix3>* start = nullptr, const Progress& go_on = {});

  /// Returns the detail rotations of the last solve, one per region vertex.
  const std::vector<Matrix3>& rotations() const;

  /// Returns the result of the last solve(); no rows before the first.
  const Points& positions() const;

  /// Returns the report of construction and last solve. It computes residuals and stretch on each call, and changes
  /// nothing.
  /// @param stored  the positions as the mesh stores them; residuals are those of stored positions
  /// @param whole   whether to include the height of detail, which costs a smoothing
  EditReport report(const Points& stored, bool whole = true) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
