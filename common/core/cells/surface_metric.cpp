// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/region_cells.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lapedit/cells/cell_pose.h"
#include "lapedit/mesh/surface_index.h"

namespace lapedit {
namespace {

/// Adds to each matrix its neighbours'.
void add_neighbours(const CompressedRows& neighbours, std::vector<Matrix3>& matrices) {
  const std::vector<Matrix3> before = matrices;
  for (int a = 0; a < neighbours.rows(); ++a) {
    for (const int b : neighbours[a]) {
      matrices[a] += before[b];
    }
  }
}

/// Returns e^x for -1 < x <= 0 by sums and products alone, so that the bits are the same on every system.
double exponential(double x) {
  double sum = 1;
  for (int k = 16; k > 0; --k) {
    sum = 1 + sum * x / k;
  }
  return sum;
}

}  // namespace

/// The shape tensor of a cell is the least-squares solution of n_a - n_b = S (c_a - c_b) over neighbouring cells b, for
/// their normals n and centres c.
void measure_metric(double size, RegionCells& cells) {
  constexpr double kHalfLogarithm = 0.45814536593707755;  // of 2.5: the ratio of squared lengths
  constexpr double kFlat = 0.5;                           // curvatures below kFlat / size change nothing
  constexpr double kLine = 1e-2;                          // of the spread, across cells in a line
  const int m = cells.count();
  std::vector<Matrix3> normals(m, Matrix3::Zero());  // in the first column
  for (int a = 0; a < m; ++a) {
    normals[a].col(0) = cells.normals.row(a).transpose();
  }
  add_neighbours(cells.neighbours, normals);
  for (Matrix3& one : normals) {
    const double length = one.col(0).norm();
    one.col(0) = length > 0 ? Vector3(one.col(0) / length) : Vector3::Zero();
  }
  std::vector<Matrix3> shapes(m, Matrix3::Zero()), spreads = shapes;
  for (int a = 0; a < m; ++a) {
    for (int k = cells.neighbours.offsets[a]; k < cells.neighbours.offsets[a + 1]; ++k) {
      const int b = cells.neighbours.values[k];
      const Vector3 edge = (cells.centres.row(a) - cells.centres.row(b)).transpose();
      shapes[a] += cells.crossing[k] * (normals[a].col(0) - normals[b].col(0)) * edge.transpose();
      spreads[a] += cells.crossing[k] * edge * edge.transpose();
    }
  }
  add_neighbours(cells.neighbours, shapes);
  add_neighbours(cells.neighbours, spreads);
  cells.metric.assign(m, Matrix3::Identity());
  cells.curvature.assign(m, 0);
  for (int a = 0; a < m; ++a) {
    const Vector3 n = normals[a].col(0);
    if (n.isZero(0) || !(spreads[a].trace() > 0)) {
      continue;
    }
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << n.unitOrthogonal(), n.cross(n.unitOrthogonal());
    Eigen::Matrix2d spread = tangents.transpose() * spreads[a] * tangents;
    spread.diagonal().array() += kLine * spread.trace();
    const Eigen::Matrix2d slope = tangents.transpose() * shapes[a] * tangents * spread.inverse(),
                          shape = 0.5 * (slope + slope.transpose());
    const double middle = shape.trace() / 2, half = 0.5 * (shape(0, 0) - shape(1, 1)), mixed = shape(0, 1);
    const double radius = std::sqrt(half * half + mixed * mixed);
    const double large = std::abs(middle) + radius, small = std::abs(std::abs(middle) - radius);
    const double q = (large - small) / (large + small + kFlat / size);
    if (!std::isfinite(q)) {
      continue;
    }
    cells.curvature[a] = large;
    if (!(radius > 0)) {
      continue;
    }
    // The reflection that keeps the direction of the eigenvalue middle + radius and reverses the other one.
    Eigen::Matrix2d along;
    along << half, mixed, mixed, -half;
    along *= (middle < 0 ? -1 : 1) / radius;
    const double less = exponential(-kHalfLogarithm * q);
    const Eigen::Matrix2d ribs =
        0.5 * (less + 1 / less) * Eigen::Matrix2d::Identity() + 0.5 * (less - 1 / less) * along;
    cells.metric[a] = n * n.transpose() + tangents * ribs * tangents.transpose();
  }
  for (int a = 0; a < m; ++a) {
    for (int k = cells.neighbours.offsets[a]; k < cells.neighbours.offsets[a + 1]; ++k) {
      const int b = cells.neighbours.values[k];
      const Vector3 edge = (cells.centres.row(a) - cells.centres.row(b)).transpose();
      const Matrix3 inverse = (0.5 * (cells.metric[a] + cells.metric[b])).inverse();
      const double factor = edge.dot(inverse * edge) / edge.squaredNorm();
      cells.crossing[k] *= std::isfinite(factor) ? factor : 1;
    }
  }
}

std::vector<Matrix3> surface_metric(const Region& region, const Points& rest, ThreadPool& pool) {
  Region free = region;
  std::fill(free.classes.begin(), free.classes.end(), VertexClass::Free);
  std::fill(free.group.begin(), free.group.end(), -1);
  const Points local = rest.rowwise() - rest.row(0);  // the bits depend neither on handles nor on the origin
  const SurfaceSize surface = size_of(local, region.faces);
  for (int i = 0; i < free.size(); ++i) {
    free.distance[i] = (local.row(i) - surface.centroid.transpose()).norm();
  }
  free.max_distance = 1e3 * surface.size;  // so that cells have one size
  free.handle_weight.clear();
  free.anchor_depth.clear();
  const RegionCells cells = make_cells(free, local, CellPose::wanted_cells(free.size()), pool);
  const CellBlend blend(cells, local, pool);
  std::vector<Matrix3> result(static_cast<std::size_t>(free.size()), Matrix3::Zero());
  constexpr int kGrain = 1024;
  for_indices(pool, free.size(), kGrain, [&](int i) {
    for (int k = 0; k < CellBlend::kReach; ++k) {
      result[i] += static_cast<double>(blend.weights(k, i)) * cells.metric[blend.cells(k, i)];
    }
  });
  return result;
}

}  // namespace lapedit
