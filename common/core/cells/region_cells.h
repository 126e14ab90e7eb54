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

}  // namespace lapedit
