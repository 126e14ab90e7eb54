// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_pose.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lapedit/deform/differential_operator.h"
#include "lapedit/deform/laplacian_system.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// Returns the positive semidefinite matrix L_ij, the integral of (grad phi_i)^T G^-1 (grad phi_j) over the cells'
/// triangles, where G is the cells' metric in the plane of a triangle, with determinant 1. An edge that no triangle
/// contains has its weight in `crossing`.
SparseMatrix stiffness_matrix(const RegionCells& cells, bool with_metric = true) {
  constexpr double kSliver = 0.05;  // twice the area over the longest edge squared; below it, gradients are inaccurate
  const int m = cells.count();
  Triplets entries;
  entries.reserve(9 * cells.triangles.size() + 4 * static_cast<std::size_t>(m));
  std::vector<char> covered(cells.neighbours.values.size(), 0);
  for (const std::array<int, 3>& t : cells.triangles) {
    const Vector3 p[3] = {cells.centres.row(t[0]).transpose(), cells.centres.row(t[1]).transpose(),
                          cells.centres.row(t[2]).transpose()};
    Vector3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    const double twice_area = normal.norm();
    const double longest =
        std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
    if (!(twice_area > kSliver * longest)) {
      continue;
    }
    normal /= twice_area;
    Eigen::Matrix<double, 3, 2> plane;
    plane << normal.unitOrthogonal(), normal.cross(normal.unitOrthogonal());
    const Eigen::Matrix2d metric =
        with_metric ? Eigen::Matrix2d(plane.transpose() *
                                      (cells.metric[t[0]] + cells.metric[t[1]] + cells.metric[t[2]]) * plane)
                    : Eigen::Matrix2d(Eigen::Matrix2d::Identity());
    const Matrix3 tensor = std::sqrt(metric.determinant()) * plane * metric.inverse() * plane.transpose();
    Vector3 gradient[3];
    for (int k = 0; k < 3; ++k) {
      gradient[k] = normal.cross(p[(k + 2) % 3] - p[(k + 1) % 3]) / twice_area;
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        entries.emplace_back(t[i], t[j], twice_area / 2 * gradient[i].dot(tensor * gradient[j]));
        if (i != j) {
          covered[cells.neighbours.entry(t[i], t[j])] = 1;
        }
      }
    }
  }
  for (int a = 0; a < m; ++a) {
    for (int k = cells.neighbours.offsets[a]; k < cells.neighbours.offsets[a + 1]; ++k) {
      if (const int b = cells.neighbours.values[k]; !covered[k] && !covered[cells.neighbours.entry(b, a)]) {
        entries.emplace_back(a, a, cells.crossing[k]);
        entries.emplace_back(a, b, -cells.crossing[k]);
      }
    }
  }
  SparseMatrix matrix(m, m);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Returns D of LaplacianKind::Surface for the areas of cells. The energy of other operators is a sum over vertices, so
/// their cells have the areas that their vertices would have in an even mesh.
Eigen::VectorXd divisor_of(const Region& region, const RegionCells& cells, LaplacianKind kind) {
  constexpr double kLeast = 1e-3;
  const std::vector<double>& sizes = kind == LaplacianKind::Surface ? cells.area : cells.vertices;
  const Eigen::VectorXd areas = Eigen::Map<const Eigen::VectorXd>(sizes.data(), cells.count());
  if (!(areas.sum() > 0)) {
    return Eigen::VectorXd::Constant(cells.count(), kMeanDivisor);
  }
  return (16 / squared_spacing(areas.sum() / region.size()) * areas.cwiseMax(kLeast * areas.mean())).cwiseSqrt();
}

/// Returns, per group, 1 if it is wider than its cells, falling to 0 for a point, which rotates its surroundings
/// little.
Eigen::VectorXd widths(const Region& region, const Points& rest, const RegionCells& cells, int groups) {
  constexpr double kWide = 0.5;  // mean squared distance from the centroid over the area of a cell
  Points centres = Points::Zero(groups, 3);
  Eigen::VectorXd count = Eigen::VectorXd::Constant(groups, 1e-300), spread = count, area = count;
  for (const bool first : {true, false}) {
    for (int i = 0; i < region.size(); ++i) {
      if (const int g = region.group[i]; g >= 0 && first) {
        centres.row(g) += rest.row(i);
        area[g] += cells.area[cells.of[i]];
        count[g] += 1;
      } else if (g >= 0) {
        spread[g] += (rest.row(i) - centres.row(g) / count[g]).squaredNorm();
      }
    }
  }
  return spread.cwiseQuotient(kWide * area).cwiseMin(1).unaryExpr([](double t) { return smooth_step(t); });
}

/// Adds up the weights of each number in a list, and sorts it by numbers.
void merge_weights(std::vector<std::pair<int, double>>& list) {
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t written = 0;
  for (const auto& [number, weight] : list) {
    if (written > 0 && list[written - 1].first == number) {
      list[written - 1].second += weight;
    } else {
      list[written++] = {number, weight};
    }
  }
  list.resize(written);
}

}  // namespace

Vector3 CoarseSystem::Held::displacement(const GroupPaths& paths) const {
  Vector3 offset = Vector3::Zero();
  for (std::size_t k = 0; k < vertices.size() && paths.has_targets(); ++k) {
    offset += vertices[k].second * paths.target_offset(vertices[k].first);
  }
  return paths.displacement(group, mean, offset);
}

/// Many handle vertices in a cell would over-determine the blend, so the constraint is on their mean, weighted by
/// squared weights. If all vertices of a cell are handle vertices, the constraint is on the cell itself, since the
/// blend at its vertices may depend on other cells.
void CoarseSystem::hold_handles(const Region& region, const Points& rest, const RegionCells& cells,
                                const CellBlend& blend, double handle_weight) {
  std::vector<int> vertices;
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Handle) {
      vertices.push_back(i);
    }
  }
  const auto key = [&](int i) { return std::make_pair(cells.of[i], region.group[i]); };
  std::stable_sort(vertices.begin(), vertices.end(), [&](int a, int b) { return key(a) < key(b); });
  for (std::size_t first = 0, last = 0; first < vertices.size(); first = last) {
    Held held = {cells.of[vertices[first]], region.group[vertices[first]], Vector3::Zero(), 0, {}, {}};
    std::vector<std::pair<int, double>>& row = held.row;
    double count = 0;
    for (last = first; last < vertices.size() && key(vertices[last]) == key(vertices[first]); ++last) {
      const int i = vertices[last];
      const double counts = region.weight(i) * region.weight(i);
      count += counts;
      held.vertices.emplace_back(i, counts);
      held.mean += counts * rest.row(i).transpose();
      for (int k = 0; k < CellBlend::kReach; ++k) {
        row.emplace_back(blend.cells(k, i), counts * static_cast<double>(blend.weights(k, i)));
      }
    }
    held.mean /= count;
    for (auto& [i, weight] : held.vertices) {
      weight /= count;
    }
    held.weight = count * handle_weight * handle_weight;
    if (static_cast<double>(last - first) == cells.vertices[held.cell]) {
      held.mean = cells.centres.row(held.cell).transpose();
      held.row = {{held.cell, 1}};
      held_.push_back(std::move(held));
      continue;
    }
    for (auto& entry : row) {
      entry.second /= count;
    }
    merge_weights(row);
    held_.push_back(std::move(held));
  }
}

CoarseSystem::CoarseSystem(const Region& region, const Points& rest, const RegionCells& cells, const CellBlend& blend,
                           const EditSettings& settings) {
  hold_handles(region, rest, cells, blend, settings.handle_weight);
  make_normal(region, rest, cells, settings);
}

/// Factors the positive definite matrix M^T M + c D M + W^2.
void CoarseSystem::make_normal(const Region& region, const Points& rest, const RegionCells& cells,
                               const EditSettings& settings) {
  const int m = cells.count();
  divisor_ = divisor_of(region, cells, settings.laplacian);
  operator_ = divisor_.cwiseInverse().asDiagonal() * stiffness_matrix(cells);
  SparseMatrix normal = SparseMatrix(operator_.transpose()) * operator_;
  stretch_ = membrane_factor(settings.membrane, region, rest, kMeanDivisor) * divisor_;
  if (settings.membrane > 0) {
    normal += stretch_.asDiagonal() * operator_;
  }
  // Sums squared weights of anchors, and a tiny weight that keeps the matrix positive definite without constraints.
  constexpr double kTrace = 1e-13;
  Eigen::VectorXd anchored = Eigen::VectorXd::Constant(m, kTrace);
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] == VertexClass::Anchor) {
      const double w = settings.anchor_weight * region.anchor_weight[i];
      anchored[cells.of[i]] += w * w;
    }
  }
  Eigen::VectorXd squared_weights = anchored;
  for (const Held& held : held_) {
    squared_weights[held.cell] += held.weight;
  }
  const int groups = 1 + *std::max_element(region.group.begin(), region.group.end());
  groups_ = groups_with_cells(region);
  const Eigen::MatrixXd held_places = make_follow(cells, anchored, squared_weights);
  loose_.assign(m, -1);
  if (static_cast<int>(groups_.size()) == groups) {  // otherwise there is a constraint in nearly every cell
    const Eigen::RowVectorXd largest = follow_.colwise().maxCoeff().cwiseMax(1e-300);  // less than 1 for weak groups
    loose_ = find_loose(cells, follow_ * largest.cwiseInverse().asDiagonal(), region.max_distance, squared_weights);
  }
  loose_of_targets_ = find_loose(cells, held_places, 1, squared_weights);
  const Eigen::VectorXd wide = widths(region, rest, cells, groups);
  for (std::size_t k = 0; k < groups_.size(); ++k) {
    follow_.col(static_cast<Eigen::Index>(k)) *= wide[groups_[k]];
  }
  Triplets entries;
  for (int c = 0; c < m; ++c) {
    entries.emplace_back(c, c, anchored[c]);
  }
  for (const Held& held : held_) {
    for (const auto& [a, wa] : held.row) {
      for (const auto& [b, wb] : held.row) {
        entries.emplace_back(a, b, held.weight * wa * wb);
      }
    }
  }
  SparseMatrix constraints(m, m);
  constraints.setFromTriplets(entries.begin(), entries.end());
  normal += constraints;
  factorise_for(region, [&] { normal_ = std::make_unique<SmallCholesky>(normal); });
}

/// Solves (L + D^2 W^2 / 4) phi_g = D^2 W_g^2 / 4. Positive off-diagonal entries of L are set to 0 and its diagonal is
/// recomputed, so the matrix is positive definite for all operators.
/// @return for each cell a mean of the places that are held, found likewise: nearly constant where one end is free
Eigen::MatrixXd CoarseSystem::make_follow(const RegionCells& cells, const Eigen::VectorXd& anchored,
                                          const Eigen::VectorXd& squared_weights) {
  const auto groups = static_cast<int>(groups_.size());
  follow_.setZero(cells.count(), groups);
  const Eigen::VectorXd squares = 0.25 * divisor_.cwiseAbs2();
  Points places = squares.cwiseProduct(anchored).asDiagonal() * cells.centres;
  for (const Held& one : held_) {
    places.row(one.cell) += squares[one.cell] * one.weight * one.mean.transpose();
    if (const int k = index_in(groups_, one.group); k >= 0) {
      follow_(one.cell, k) += squares[one.cell] * one.weight;
    }
  }
  SparseMatrix matrix = stiffness_matrix(cells, false);
  for (int c = 0; c < cells.count(); ++c) {
    double sum = squares[c] * squared_weights[c];
    for (SparseMatrix::InnerIterator entry(matrix, c); entry; ++entry) {
      entry.valueRef() = entry.row() == c ? 0 : std::min(entry.value(), 0.0);
      sum -= entry.value();
    }
    matrix.coeffRef(c, c) = sum;
  }
  matrix.makeCompressed();  // a cell without neighbours had no entry
  SmallCholesky factor(matrix);
  Points three = Points::Zero(cells.count(), 3);
  for (int g = 0; g < groups; g += 3) {
    const int count = std::min(3, groups - g);
    three.leftCols(count) = follow_.middleCols(g, count);
    factor.solve(three, three);
    follow_.middleCols(g, count) = three.leftCols(count);
  }
  factor.solve(places, places);
  return places;
}

/// Numbers the loose parts: connected cells without constraints where functions are nearly constant, so no forces pass.
/// @param size  length over which they change by 1 elsewhere
std::vector<int> CoarseSystem::find_loose(const RegionCells& cells, const Eigen::MatrixXd& follow, double size,
                                          const Eigen::VectorXd& squared_weights) {
  constexpr double kSlope = 0.4;  // over the region's size
  constexpr double kFree = 1e-6;
  constexpr int kFew = 40;  // with fewer cells, rotations converge anyway, and cells around a limb are collinear
  std::vector<char> is_loose(cells.count());
  std::vector<int> loose;
  for (int a = 0; a < cells.count(); ++a) {
    double slope = 0;
    for (const int b : cells.neighbours[a]) {
      slope +=
          (follow.row(a) - follow.row(b)).squaredNorm() / (cells.centres.row(a) - cells.centres.row(b)).squaredNorm();
    }
    const bool slopes = !(slope * size * size < kSlope * kSlope);
    is_loose[a] = cells.count() >= kFew && squared_weights[a] < kFree && !slopes ? 1 : 0;
  }
  connected_components(cells.neighbours, loose, is_loose);
  std::vector<int> number(cells.count(), -1);
  int parts = 0;
  for (int c = 0; c < cells.count(); ++c) {
    int& one = number[loose[c]];
    one = is_loose[c] && one < 0 ? parts++ : one;
    loose[c] = one;
  }
  return loose;
}

void CoarseSystem::add_rotated(const Points& rotated, Points& right) const {
  for (Eigen::Index c = 0; c < rotated.rows(); ++c) {
    right.row(c) += stretch_[c] * rotated.row(c);
  }
  right.noalias() += operator_.transpose() * rotated;
}

}  // namespace lapedit
