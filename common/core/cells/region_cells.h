// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "lapedit/base/simd.h"
#include "lapedit/base/thread_pool.h"
#include "lapedit/deform/differential_operator.h"
#include "lapedit/mesh/region.h"

namespace lapedit {

/// Returns a vector of three or four numbers in single precision; the fourth of three is 0.
template <class Vector>
Floats4 floats4(const Vector& v) {
  return Floats4{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                 v.size() > 3 ? static_cast<float>(v[v.size() - 1]) : 0};
}

/// A region divided into patches of neighbouring vertices, and the data of each patch that a coarse model needs.
///
/// Cells are packed along the surface by pack_cells(), more densely near the handle, where an edit bends most. Where
/// three cells meet in a face their centroids span a triangle, so that the cells form a coarse mesh of the region. All
/// data depends only on the region and its rest pose, bit for bit, whatever the number of threads.
struct RegionCells {
  std::vector<int> of;        ///< cell of each vertex of the region
  Points centres;             ///< centroids at rest, cells x 3; at open borders those of the vertices on the border
  CompressedRows neighbours;  ///< cells connected by an edge, ascending
  /// Per entry of neighbours: the weight of the pair, at least about 1e-3: the flux through their common border of the
  /// linear function that grows by 1 from one centre to the other, measured with the metric.
  std::vector<double> crossing;
  std::vector<std::array<int, 3>> triangles;  ///< cells that meet in a face, ascending, each once

  /// Per cell: the number of its vertices, and the sum over them of a third of the area of their faces.
  std::vector<double> vertices, area;
  double free_area = 0;  ///< the part of the area that belongs to free vertices
  Points normals;        ///< sums of those faces' area normals

  std::vector<Matrix3> metric;    ///< of each cell, see measure_metric()
  std::vector<double> curvature;  ///< of each cell, the largest, without sign

  int count() const { return static_cast<int>(vertices.size()); }
};

/// @param rest    size() x 3, the region's rest pose about a local origin
/// @param target  number of cells wanted, approximately met: see pack_cells()
/// Cost: O(edges).
RegionCells make_cells(const Region& region, const Points& rest, int target, ThreadPool& pool);

/// Weights by which vertices follow cells. Each vertex follows at most kReach cells; the weights sum to 1, reproduce
/// linear functions along the surface (moving least squares), and fall off smoothly with the distance from a cell.
struct CellBlend {
  static constexpr int kReach = 8;
  /// One column per vertex; unused entries repeat the first cell with weight 0.
  Eigen::Array<int, kReach, Eigen::Dynamic> cells;
  Eigen::Array<float, kReach, Eigen::Dynamic> weights;

  /// Cost: O(vertices). @param rest as above
  CellBlend(const RegionCells& from, const Points& rest, ThreadPool& pool);
};

/// The cells of a region as a surface: weights of neighbours, normals, smoothing.
class CellSurface {
 public:
  /// @param cells  must outlive the object
  explicit CellSurface(const RegionCells& cells);

  /// The weight of an entry of cells.neighbours in averages over a cell's surroundings.
  double nearness(int entry) const { return nearness_[entry]; }
  /// The contribution of a neighbour's displacement to the gradient along the surface, in a basis of the cell's tangent
  /// plane.
  const Vector2& slope(int entry) const { return slope_[entry]; }
  /// Returns the unit normal at a cell for the given positions of all cells; zero if it is undefined.
  Vector3 normal(int cell, const Points& at) const;
  /// Replaces each position by the mean of its own and its neighbours' positions, `rounds` times.
  /// @param other  scratch
  void smooth(int rounds, Points& positions, Points& other) const;

 private:
  const RegionCells& cells_;
  std::vector<double> nearness_;
  std::vector<Vector2> slope_;
};

// Of cell_packing.cpp.

/// Returns the handle groups that have cells of their own, ascending: all, or the largest ones if there are more than
/// 400 groups, since each group would need a cell. Vertices of the others are like free vertices for the cells.
/// O(vertices)
std::vector<int> groups_with_cells(const Region& region);

/// Divides a region into patches of neighbouring vertices that are about as wide as long, whatever the shape of the
/// triangles.
///
/// Seeds are packed along the surface: from the boundaries of the handles outwards and inwards, each vertex that is
/// farther than the local spacing from all earlier seeds becomes a seed. A cell consists of the vertices that are
/// nearest to its seed along edges. The spacing grows with the distance from the handles, and towards the inside of
/// rigid groups and of the anchor band, where rotations do not vary. Vertices at the same distance from the handles are
/// sorted by their distance from the region's middle, then by the edges around them and the nearest group, then by
/// coordinates, and by number only if coordinates are equal. Two vertices that are each other's mirror images and near
/// each other begin one cell. Neighbouring groups of groups_with_cells() have cells of their own. The result is the
/// same for any number of threads.
/// @param rest    size() x 3, the region's rest pose about a local origin
/// @param target  wanted number of cells; the part that is not rigid has at most one cell per five vertices
/// @param of      out: the cell of each vertex of the region
/// @return        the number of cells, close to `target`
/// Cost: O(edges).
int pack_cells(const Region& region, const Points& rest, int target, ThreadPool& pool, std::vector<int>& of);

// Of surface_metric.cpp.

/// Computes RegionCells::curvature and metric: for each cell a symmetric matrix of determinant 1. Along the surface,
/// lengths are up to 1.26 times shorter in the direction of the largest curvature and longer across it. Curvature is
/// that of the cells, so details have none. This makes limbs stiff around their axis, so that they stay round when they
/// are bent or twisted. On flat and on round surfaces all matrices are the identity.
/// @param size  the region's, see size_of(). Cost: O(cells).
void measure_metric(double size, RegionCells& cells);

/// Returns the metric of each vertex of a region, blended from cells that depend on neither handles nor anchors.
/// Cost: O(edges).
std::vector<Matrix3> surface_metric(const Region& region, const Points& rest, ThreadPool& pool);

}  // namespace lapedit
