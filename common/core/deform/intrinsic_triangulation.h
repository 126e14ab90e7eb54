// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "lapedit/base/compressed_rows.h"
#include "lapedit/base/types.h"

namespace lapedit {

/// The Laplacian of a surface: cotangent weights and Voronoi areas of its intrinsic Delaunay triangulation.
///
/// That triangulation has the same vertices and the same surface, with edges flipped along the surface until the angles
/// opposite to each inner edge sum to at most 180 degrees. Its weights are never negative, and weights and areas depend
/// on the surface and its vertices alone, not on how they were triangulated. Sources: A. Bobenko, B. Springborn, A
/// discrete Laplace-Beltrami operator for simplicial surfaces, 2007; N. Sharp, K. Crane, A Laplacian for nonmanifold
/// triangle meshes, SGP 2020 (mollified lengths).
struct SurfaceLaplacian {
  CompressedRows neighbours;    ///< per vertex, ascending; each edge in both rows; no edges of weight 0
  std::vector<double> weights;  ///< w_ij > 0, one per entry of neighbours, the same in both rows
  Eigen::VectorXd areas;        ///< per vertex, at least 0; they sum to the surface's area; 0 without faces
};

/// Edges of one face or of more than two faces are borders, which are not flipped. Faces may be oriented in any way,
/// and may have no area: lengths are first raised by the least amount with which each triangle has one.
/// @param faces   with three different corners each
/// @param metric  a symmetric positive definite matrix per vertex, by whose mean over both ends e^T G e edges e are
///                measured; null: by their lengths
/// Cost: O(faces) on usual meshes; flips are few unless triangles are long.
SurfaceLaplacian surface_laplacian(const Points& points, const Faces& faces,
                                   const std::vector<Matrix3>* metric = nullptr);

}  // namespace lapedit
