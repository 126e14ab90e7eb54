// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// A step from a displacement d towards the solution with given rotations, A^-1 r with the existing factor of A. The
/// residual r is what is left of the energy's gradient. With d from the rigidly moved pose, the order k, and the
/// membrane's c L,
///
///     r = ((M^k)^T + c D) M^(k-1) ((R - I) delta - M d) + W^2 (c - d),  where M = D^-1 L.
///
/// (R - I) delta are the changes of the rotated differential coordinates (step 3 of the paper's section 4).
/// EditMethod::Paper rotates whole coordinates, R_i delta_i; the others each edge by the mean of its ends' rotations,
/// so that flat parts of the surface bend too, and limbs keep their thickness. Both differences are summed over the
/// same edges, so nothing cancels that is much larger than the result.
class CorrectionStep {
 public:
  /// @param system  must outlive the object
  explicit CorrectionStep(const LaplacianSystem& system);

  /// @param rotations     R_i, one per vertex, relative to the rigidly moved pose
  /// @param displacement  d, size() x 3
  /// @return              the step, valid until the next call; exactly zero where r is zero
  /// Cost: O(edges), and reading the factor twice. Nothing is allocated after the first call.
  const Points& operator()(const EditConstraints& constraints, const std::vector<Matrix3>& rotations,
                           const Points& displacement);

 private:
  struct Edges;
  const Points& with_links(const EditConstraints& constraints, const std::vector<Matrix3>& rotations,
                           const Points& displacement);

  const LaplacianSystem& system_;
  RefinedSolver solver_;
  std::vector<int> constrained_;  // vertices with a weight
  Points edges_, product_, with_links_, residual_, step_;
};

}  // namespace lapedit
