// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/edit_constraints.h"
#include "lapedit/deform/laplacian_system.h"

namespace lapedit {

/// The residual of the normal equations at a pose: what is left of the energy's gradient. With the displacement d from
/// the rigidly moved pose, the order k, and the membrane's c L,
///
///     r = ((M^k)^T + c D) M^(k-1) ((R - I) delta - M d) + W^2 (c - d),  where M = D^-1 L.
///
/// (R - I) delta are the changes of the rotated differential coordinates (step 3 of the paper's section 4).
/// EditMethod::Paper rotates whole coordinates, R_i delta_i; the others each edge by the mean of its ends' rotations,
/// so that flat parts of the surface bend too, and limbs keep their thickness. Both differences are summed over the
/// same edges, so nothing cancels that is much larger than the result.
class EditResidual {
 public:
  /// @param system  must outlive the object
  explicit EditResidual(const LaplacianSystem& system);

  /// @param rotations     R_i, one per vertex, relative to the rigidly moved pose
  /// @param displacement  d, size() x 3
  /// @param residual      out, size() x 3; exactly zero where neither is
  /// Cost: O(edges). Nothing is allocated after the first call.
  void compute(const EditConstraints& constraints, const std::vector<Matrix3>& rotations, const Points& displacement,
               Points& residual);

 private:
  struct Edges;
  const Points& with_links(const EditConstraints& constraints, const std::vector<Matrix3>& rotations,
                           const Points& displacement);

  const LaplacianSystem& system_;
  std::vector<int> constrained_;  // vertices with a weight
  Points edges_, product_, with_links_;
};

}  // namespace lapedit
