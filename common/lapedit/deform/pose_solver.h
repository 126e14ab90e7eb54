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

/// One region with its handles, ready to be posed again and again, exactly (paper, sections 3 to 5).
///
/// Minimises |M^k x - M^(k-1) R delta|^2 + sum_i w_i^2 |x_i - c_i|^2 over the region's vertices, k the order, delta = M
/// p of the rest pose p and R the detail rotations: with k = 1 the paper's system; for k > 1 the coordinates are turned
/// before the rest of the order is taken, which is the paper's too where R does not vary. Solved for the displacement
/// from the rest pose, so that what does not move keeps its bits. A constructed object is always usable; other handles,
/// anchors or settings mean a new one, which can take over the old one's factor.
class PoseSolver {
 public:
  /// @param mesh      rest pose; not kept
  /// @param previous  a solver that is not wanted any more: what it has and still fits, the factor above all, is
  ///                  shared, so that another small handle in the same region with the same anchors is ready in a
  ///                  fraction of the time. The result has the same bits with and without
  /// Cost: operator, one sparse Cholesky factorisation, smoothing: all of it once, nothing of it in solve().
  /// @throws EditError (BadParameter, IllConditioned, Cancelled)
  PoseSolver(const TriangleMesh& mesh, std::shared_ptr<const RestPose> rest, const EditSettings& settings,
             const Progress& progress = {}, std::unique_ptr<PoseSolver> previous = nullptr);
  ~PoseSolver();

  const LaplacianSystem& system() const;
  const std::string& taken_over() const;  ///< see EditReport::taken_over

  /// Positions of the region's vertices after its handle groups have moved.
  ///
  /// A component without anchors is first carried along by the mean of its groups' maps, so that it follows a single
  /// one exactly; one with anchors by the map given for them.
  /// @param handles  one motion per handle group; an affine map is one
  /// @param anchors  where the anchors go; in an edit they stay
  /// @param start    with DetailRotation::LocalGlobal the rotations of the first pass, one per vertex, relative to
  /// where
  ///                 it is carried; nothing: the identity
  /// @return         size() x 3, model units, row i belongs to region().mesh_vertex[i]; valid until the next call
  /// @throws EditError (NotFinite) if a map or the result is not finite; (Cancelled); the editor stays usable
  /// @param go_on    asked now and then; called with the fraction 0
  /// Cost: one unrotated solve, unless rotations are estimated from a fall-off, and one per rotation pass, each of some
  /// steps of refinement; nothing is allocated after the first call.
  const Points& solve(const std::vector<HandleMotion>& handles, const Affine& anchors = Affine::Identity(),
                      const std::vector<Matrix3>* start = nullptr, const Progress& go_on = {});

  /// Detail rotations of the last solve, one per region vertex.
  const std::vector<Matrix3>& rotations() const;

  /// What the last solve() returned; no rows before the first.
  const Points& positions() const;

  /// Report of construction and last solve; works out residuals and stretch on each call, and changes nothing.
  /// @param stored  the positions as the mesh that takes them stores them, which is what residuals are of
  /// @param whole   with the height of detail, which takes a smoothing
  EditReport report(const Points& stored, bool whole = true) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapedit
