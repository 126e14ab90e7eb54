// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "lapedit/mesh/region.h"

namespace lapedit {

/// Which linear differential operator measures the detail (paper, section 3).
enum class LaplacianKind {
  /// alpha_ji = 1 / valence(j): the paper's choice for its edits.
  Umbrella,
  /// alpha_ji proportional to the edge's cotangent weight: half the sum of the cotangents opposite to it.
  ///
  /// Negative weights (obtuse pairs) are replaced by zero, so no row has a zero or negative sum; cotangents are clamped
  /// at kLargestCotangent. An edge of a triangle without area (or of no triangle, or with a non-finite corner) gets the
  /// weight of an equilateral mesh, 1 / sqrt(3). Source: U. Pinkall, K. Polthier, Computing discrete minimal surfaces
  /// and their conjugates, 1993.
  Cotangent,
  /// alpha_ji proportional to the mean of the edge's two mean-value weights, (tan(a / 2) + tan(b / 2)) / length, where
  /// a and b are the angles at the corner next to the edge. Weights are never negative or nearly zero, so obtuse and
  /// uneven triangles stay connected. They are clamped to 1/1000 to 1000 times the weight in an equilateral mesh of the
  /// region's mean edge length; edges of triangles without area (or of none) have that weight. Source: M. Floater, Mean
  /// value coordinates, CAGD 2003.
  MeanValue,
  /// Cotangent weights and areas of the intrinsic Delaunay triangulation, see SurfaceLaplacian: the same surface gives
  /// the same operator, however it is triangulated. With h^2 = 2 / sqrt(3) times the mean area, M = D^-1 L, where
  /// D_i^2 = (4 / h)^2 A_i + (sum_j w_ij / 1000)^2, so that |M x|^2 is h^2 / 16 times the integral of the squared
  /// Laplacian of x; the second term bounds M at slivers. Edges in no face of the region have the weight of an
  /// equilateral mesh.
  Surface
};

/// Returns the name of the weights in JSON.
const char* name(LaplacianKind kind);

/// Weights w_ji >= 0 before rows are divided by D.
struct EdgeWeights {
  CompressedRows neighbours;   ///< region.neighbours; of LaplacianKind::Surface those of the intrinsic triangulation
  std::vector<double> values;  ///< one per entry of neighbours
  std::vector<char> uniform;   ///< marks entries without usable faces, which have the weight of an equilateral mesh;
                               ///< umbrella and surface: empty
  Eigen::VectorXd areas = {};  ///< of LaplacianKind::Surface
};

/// @param symmetric  gives both directions of each edge the larger weight; otherwise rows whose cotangent weights are
///                   all zero are not symmetric
EdgeWeights edge_weights(LaplacianKind kind, const Region& region, const TriangleMesh& mesh, bool symmetric = false,
                         const std::vector<Matrix3>* metric = nullptr);

/// An n x n operator M over a region (paper, section 3): (M p)_j = p_j - sum_i alpha_ji p_i. Its off-diagonal entries
/// are -alpha_ji <= 0, and rows sum to 0; the row of a vertex without neighbours is zero. M is not symmetric, but M =
/// D^-1 L with the positive diagonal D, whose entries are the rows' sums of weights, so that the diagonal of M is 1,
/// except with LaplacianKind::Surface. L is symmetric positive semidefinite if weights are symmetric; its kernel is the
/// constants on each connected component.
struct DifferentialOperator {
  SparseMatrix matrix;
  Eigen::VectorXd divisor;  ///< D
  double mean = 0;          ///< of D on an even mesh
};

/// @param symmetric  as for edge_weights(); @param metric  of LaplacianKind::Surface, see surface_laplacian()
DifferentialOperator differential_operator(LaplacianKind kind, const Region& region, const TriangleMesh& mesh,
                                           bool symmetric = false, const std::vector<Matrix3>* metric = nullptr);

/// The same, of known weights.
DifferentialOperator differential_operator(LaplacianKind kind, const EdgeWeights& weights);

/// Returns M^k.
SparseMatrix power(const SparseMatrix& matrix, int order);

/// Refuses vertices with so many neighbours that the normal matrix, whose entries are estimated, would take most of the
/// memory: that of order 1 has the square of their number. O(vertices)
/// @param longest  vertices with more neighbours have one vector only, see FactoredNormalMatrix
/// @throws EditError (BadParameter)
void refuse_fans(const Region& region, int order, int longest);

/// Returns h^2, the squared edge length of an equilateral mesh whose vertices have this mean area.
inline double squared_spacing(double mean_area) {
  return 1.1547005383792515 * mean_area;  // 2 / sqrt(3)
}

/// The mean of D on an even mesh with LaplacianKind::Surface.
constexpr double kMeanDivisor = 4;

/// Returns the cost c of stretching against bending. The energy of an edit is |M x|^2 + c x^T L x, where M = D^-1 L is
/// the operator and L its stiffness matrix, symmetric positive semidefinite: x^T L x = sum_ij w_ij |x_i - x_j|^2 / 2.
/// Since M is about h^2 / 4 times the surface's Laplacian,
///
///     c = membrane / s^2 * (h^2 / 4) / mean D
///
/// makes the ratio of the two energies membrane / s^2 for any triangulation. s is the region's size: sqrt(2) times the
/// root mean square distance from the centroid, by area, which is the radius of a disc. Stretching then spreads over
/// the whole region except a length of s / sqrt(membrane) around handles and boundary, where bending keeps the surface
/// smooth. That length is at least half an edge, so that handles reach their targets in coarse regions too. Neither
/// handle nor anchors enter, so the next handle can reuse the factor. Source: M. Botsch, O. Sorkine, On linear
/// variational surface deformation methods, TVCG 2008, section 3.
/// @param rest  size() x 3
/// @param mean  mean of D
/// @return      c; 0 without a membrane or an area
double membrane_factor(double membrane, const Region& region, const Points& rest, double mean);

}  // namespace lapedit
