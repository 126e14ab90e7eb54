// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_surface.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace lapedit {

/// The gradient of x along the surface at cell a is J = sum_b (x_b - x_a) s_ab^T with s_ab = g_ab (sum_b g_ab t t^T)^-1
/// t, where t is the edge to a neighbour in the tangent plane and g its nearness. A cell whose neighbours are collinear
/// has no gradient, since rounding errors would keep rotations from converging.
CellSurface::CellSurface(const RegionCells& cells) : cells_(cells) {
  constexpr double kFlat = 1e-6, kLine = 1e-3;
  nearness_.resize(cells_.neighbours.values.size());
  slope_.resize(nearness_.size());
  for (int a = 0; a < cells_.count(); ++a) {
    const Vector3 sum = cells_.normals.row(a).transpose();
    const Vector3 normal = sum.norm() > 0 ? Vector3(sum.normalized()) : Vector3(Vector3::UnitZ());
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << normal.unitOrthogonal(), normal.cross(normal.unitOrthogonal());
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      const int b = cells_.neighbours.values[k];
      nearness_[k] = cells_.crossing[k];
      slope_[k] = tangents.transpose() * (cells_.centres.row(b) - cells_.centres.row(a)).transpose();
      spread += nearness_[k] * slope_[k] * slope_[k].transpose();
    }
    const double size = spread.trace();
    const double used = spread.determinant() > kLine * size * size ? 1 : 0;
    spread.diagonal().array() += size > 0 ? kFlat * size : 1;
    const Eigen::Matrix2d inverse = spread.inverse();
    for (int k = cells_.neighbours.offsets[a]; k < cells_.neighbours.offsets[a + 1]; ++k) {
      slope_[k] = used * nearness_[k] * (inverse * slope_[k]).eval();
    }
  }
}

Vector3 CellSurface::normal(int cell, const Points& at) const {
  Vector3 first = Vector3::Zero(), second = Vector3::Zero();
  for (int k = cells_.neighbours.offsets[cell]; k < cells_.neighbours.offsets[cell + 1]; ++k) {
    const Vector3 edge = (at.row(cells_.neighbours.values[k]) - at.row(cell)).transpose();
    first += slope_[k][0] * edge;
    second += slope_[k][1] * edge;
  }
  const Vector3 normal = first.cross(second);
  const double length = normal.norm();
  return length > 0 && std::isfinite(length) ? Vector3(normal / length) : Vector3(Vector3::Zero());
}

void CellSurface::smooth(int rounds, Points& positions, Points& other) const {
  for (int round = 0; round < rounds; ++round) {
    other = positions;
    for (int a = 0; a < cells_.count(); ++a) {
      Eigen::RowVector3d sum = other.row(a);
      for (const int b : cells_.neighbours[a]) {
        sum += other.row(b);
      }
      positions.row(a) = sum / (1 + static_cast<double>(cells_.neighbours[a].size()));
    }
  }
}

}  // namespace lapedit
