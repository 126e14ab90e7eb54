// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/deform/handle_transform.h"
#include "lapedit/mesh/region.h"

namespace quality {

/// The same by any method.
struct MethodResult {
  lapedit::Points positions;  ///< of the whole mesh
  double prepare_ms = 0;      ///< until the handle can be moved
  double solve_ms = 0;        ///< the edit, settled
  double frame_ms = 0;        ///< a frame of a drag
  bool fast_frame = true;     ///< a frame is not the settled edit over again
};

enum class Arap { Original, SmoothRotations };

/// CGAL's Surface_mesh_deformation with its defaults: the region is its region of interest, the handles and all
/// stationary anchors are its control vertices. A frame is one iteration. Faces that make the mesh no manifold are
/// left out.
/// @throws std::runtime_error if CGAL cannot factorise its matrix
MethodResult arap(Arap kind, const lapedit::TriangleMesh& mesh, const lapedit::Region& region,
                  const std::vector<lapedit::Affine>& maps, int iterations);

}  // namespace quality
