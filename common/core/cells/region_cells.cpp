// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/region_cells.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "lapedit/base/simd.h"
#include "lapedit/mesh/surface_index.h"

namespace lapedit {
namespace {

using Four = Floats4;

constexpr int kChunks = 8;  // of faces and edges; fixed, so that sums do not depend on the number of threads

Points centroids(const std::vector<int>& of, const Points& rest, int count, std::vector<double>& sizes) {
  Points centres = Points::Zero(count, 3);
  sizes.assign(count, 0);
  for (std::size_t i = 0; i < of.size(); ++i) {
    centres.row(of[i]) += rest.row(static_cast<Eigen::Index>(i));
    sizes[of[i]] += 1;
  }
  for (int c = 0; c < count; ++c) {
    centres.row(c) /= sizes[c];
  }
  return centres;
}

/// Moves the centres of cells at an open border onto the border. Otherwise the cells' triangles would miss a strip of
/// half a cell there, and its stiffness.
void reach_borders(const Region& region, const Points& rest, RegionCells& cells) {
  std::vector<int> faces(region.size(), 0);
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      ++faces[region.faces(f, k)];
    }
  }
  std::vector<int> found(cells.count(), 0);
  for (int i = 0; i < region.size(); ++i) {
    if (region.classes[i] != VertexClass::Anchor && region.neighbours[i].size() > faces[i]) {
      const int c = cells.of[i];
      if (found[c]++ == 0) {
        cells.centres.row(c).setZero();
      }
      cells.centres.row(c) += (rest.row(i) - cells.centres.row(c)) / found[c];
    }
  }
}

// --- Sums over cells -------------------------------------------------------------------------------------------------

/// What two neighbouring cells share.
struct Crossing {
  int to;
  double flux = 0;  // through faces
  int edges = 0;
};

/// Contributions of one chunk of the region's faces and edges to the cells.
struct PartialSums {
  std::vector<double> area;
  double free_area = 0;
  Points normals;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::vector<Crossing>> crossing;  // per cell

  explicit PartialSums(int count) : area(count, 0), normals(Points::Zero(count, 3)), crossing(count) {}

  Crossing& between(int from, int to) {
    auto& list = crossing[from];
    auto known = std::find_if(list.begin(), list.end(), [to](const Crossing& entry) { return entry.to == to; });
    return known != list.end() ? *known : list.emplace_back(Crossing{to});
  }
};

class CellSums {
 public:
  CellSums(const Region& region, const Points& rest, RegionCells& cells, ThreadPool& pool)
      : region_(region), rest_(rest), cells_(cells), pool_(pool) {}

  void take();

 private:
  void add_face(PartialSums& to, Eigen::Index face) const;
  void merge(std::vector<PartialSums>& chunks);
  void merge_neighbours(std::vector<PartialSums>& chunks);

  const Region& region_;
  const Points& rest_;
  RegionCells& cells_;
  ThreadPool& pool_;
};

/// The border between two cells runs from the middles of a face's edges to its centroid.
void CellSums::add_face(PartialSums& to, Eigen::Index face) const {
  int cell[3];
  Vector3 corner[3];
  for (int k = 0; k < 3; ++k) {
    cell[k] = cells_.of[region_.faces(face, k)];
    corner[k] = rest_.row(region_.faces(face, k)).transpose();
  }
  const Vector3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  const double length = normal.norm(), fraction = length / 6;
  for (int k = 0; k < 3; ++k) {
    to.normals.row(cell[k]) += normal.transpose();
    to.area[cell[k]] += fraction;
    to.free_area += region_.classes[region_.faces(face, k)] == VertexClass::Free ? fraction : 0;
    const int here = cell[k], there = cell[(k + 1) % 3];
    if (here != there && length > 0) {
      const Vector3 step = (cells_.centres.row(there) - cells_.centres.row(here)).transpose();
      const Vector3 border = (2 * corner[(k + 2) % 3] - corner[k] - corner[(k + 1) % 3]) / 6;
      const double squared = step.squaredNorm(), through = step.dot(border.cross(normal)) / length;
      const double flux = squared > 0 ? through / squared : 0;
      to.between(here, there).flux += flux;
      to.between(there, here).flux += flux;
    }
  }
  if (cell[0] != cell[1] && cell[1] != cell[2] && cell[2] != cell[0]) {
    std::sort(cell, cell + 3);
    to.triangles.push_back({cell[0], cell[1], cell[2]});
  }
}

void CellSums::merge(std::vector<PartialSums>& chunks) {
  const int m = cells_.count();
  cells_.area.assign(m, 0);
  cells_.normals.setZero(m, 3);
  for (const PartialSums& chunk : chunks) {
    for (int c = 0; c < m; ++c) {
      cells_.area[c] += chunk.area[c];
    }
    cells_.normals += chunk.normals;
    cells_.free_area += chunk.free_area;
    cells_.triangles.insert(cells_.triangles.end(), chunk.triangles.begin(), chunk.triangles.end());
  }
  std::sort(cells_.triangles.begin(), cells_.triangles.end());
  cells_.triangles.erase(std::unique(cells_.triangles.begin(), cells_.triangles.end()), cells_.triangles.end());
}

void CellSums::merge_neighbours(std::vector<PartialSums>& chunks) {
  constexpr double kLeast = 1e-3;   // so that neighbours stay connected
  constexpr double kLink = 0.0173;  // of an edge without faces, as in the operator: 0.03 cot 60 degrees
  cells_.neighbours.offsets.assign(1, 0);
  std::vector<Crossing> all;
  for (int c = 0; c < cells_.count(); ++c) {
    all.clear();
    for (const PartialSums& chunk : chunks) {
      for (const Crossing& one : chunk.crossing[c]) {
        const auto known =
            std::find_if(all.begin(), all.end(), [&](const Crossing& other) { return other.to == one.to; });
        Crossing& sum = known != all.end() ? *known : all.emplace_back(Crossing{one.to});
        sum.flux += one.flux;
        sum.edges += one.edges;
      }
    }
    std::sort(all.begin(), all.end(), [](const Crossing& a, const Crossing& b) { return a.to < b.to; });
    for (const Crossing& one : all) {
      cells_.neighbours.values.push_back(one.to);
      cells_.crossing.push_back(std::max(one.flux != 0 ? one.flux : kLink * one.edges, kLeast));
    }
    cells_.neighbours.offsets.push_back(static_cast<int>(cells_.neighbours.values.size()));
  }
}

void CellSums::take() {
  std::vector<PartialSums> chunks(kChunks, PartialSums(cells_.count()));
  in_chunks(pool_, kChunks, region_.size(), [&](int chunk, Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      for (const int j : region_.neighbours[static_cast<int>(i)]) {
        if (cells_.of[j] != cells_.of[i]) {
          ++chunks[chunk].between(cells_.of[i], cells_.of[j]).edges;
        }
      }
    }
  });
  in_chunks(pool_, kChunks, region_.faces.rows(), [&](int chunk, Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index f = first; f < last; ++f) {
      add_face(chunks[chunk], f);
    }
  });
  merge(chunks);
  merge_neighbours(chunks);
}

// --- Blending --------------------------------------------------------------------------------------------------------

/// Returns, for each cell, the cell, its neighbours and their neighbours, ascending.
CompressedRows two_rings(const RegionCells& cells) {
  CompressedRows result;
  std::vector<int> row;
  for (int c = 0; c < cells.count(); ++c) {
    row.assign(1, c);
    for (const int near : cells.neighbours[c]) {
      row.push_back(near);
      row.insert(row.end(), cells.neighbours[near].begin(), cells.neighbours[near].end());
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    result.values.insert(result.values.end(), row.begin(), row.end());
    result.offsets.push_back(static_cast<int>(result.values.size()));
  }
  return result;
}

/// Returns the squared reach of each cell, scaled: 1.35 times the mean distance to its neighbours' centres, and at
/// least 1.1 times the distance to its farthest vertex.
std::vector<float> squared_reaches(const RegionCells& cells, const Points& rest, double scale) {
  constexpr double kBeyondNeighbours = 1.35, kBeyondVertices = 1.1;
  std::vector<double> squared(cells.count(), 0);
  for (std::size_t i = 0; i < cells.of.size(); ++i) {
    double& most = squared[cells.of[i]];
    most = std::max(most, (rest.row(static_cast<Eigen::Index>(i)) - cells.centres.row(cells.of[i])).squaredNorm());
  }
  std::vector<float> result(cells.count());
  for (int c = 0; c < cells.count(); ++c) {
    double sum = 0;
    for (const int near : cells.neighbours[c]) {
      sum += (cells.centres.row(near) - cells.centres.row(c)).norm();
    }
    const int count = cells.neighbours[c].size();
    const double reach =
        scale * std::max(count > 0 ? kBeyondNeighbours * sum / count : 0.0, kBeyondVertices * std::sqrt(squared[c]));
    result[c] = static_cast<float>(std::max(reach * reach, static_cast<double>(std::numeric_limits<float>::min())));
  }
  return result;
}

/// Computes blend weights. A cell of reach T has the weight w = (1 - t^2 / T^2)^2 at the distance t. The weights are
/// corrected to reproduce linear functions along the surface: w_k (1 + c . (e_k - e)) with e_k = C_k - p, e their mean,
/// S their covariance (positive definite after regularisation) and c = -S^-1 e.
class Weigher {
 public:
  Weigher(const RegionCells& cells, const Points& rest);

  /// @param to,weights  out: CellBlend::kReach cells, and their weights
  void operator()(const Vector3& position, int cell, int* to, float* weights) const;

 private:
  struct Candidate {
    Four position;  // from the centre of the row's cell
    float faster;   // 1 / T^2
    int cell;
  };
  struct Reaching {
    Four offset;  // to the cell's centre
    float weight;
    int cell;
  };
  static constexpr int kRoom = 64;
  int reaching(Four position, int cell, Reaching* found) const;

  const RegionCells& cells_;
  double scale_;  // power of two that scales lengths to about 1, so that single precision holds their squares
  std::vector<int> offsets_;
  std::vector<Candidate> candidates_;  // each cell with its neighbours and theirs
};

Weigher::Weigher(const RegionCells& cells, const Points& rest) : cells_(cells) {
  const double largest = rest.cwiseAbs().maxCoeff();
  scale_ = largest > 0 ? std::ldexp(1.0, -std::ilogb(largest)) : 1;
  const CompressedRows rings = two_rings(cells);
  const std::vector<float> reaches = squared_reaches(cells, rest, scale_);
  offsets_ = rings.offsets;
  candidates_.resize(rings.values.size());
  for (int c = 0; c < cells.count(); ++c) {
    for (int k = rings.offsets[c]; k < rings.offsets[c + 1]; ++k) {
      const int other = rings.values[k];
      const Vector3 position = scale_ * (cells.centres.row(other) - cells.centres.row(c)).transpose();
      candidates_[k] = {floats4(position), 1 / reaches[other], other};
    }
  }
}

/// Finds the cells that reach a position, at most the kReach with the largest weights. @return their number
int Weigher::reaching(Four position, int cell, Reaching* found) const {
  int count = 0;
  for (int k = offsets_[cell]; k < offsets_[cell + 1]; ++k) {
    const Candidate& candidate = candidates_[k];
    const Four e = candidate.position - position;
    const float rest = 1 - (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) * candidate.faster;
    found[count] = {e, rest * rest, candidate.cell};
    count += rest > 0 && count < kRoom - 1 ? 1 : 0;  // without an unpredictable branch
  }
  if (count > CellBlend::kReach) {
    float weights[kRoom];
    std::transform(found, found + count, weights, [](const Reaching& one) { return one.weight; });
    std::nth_element(weights, weights + CellBlend::kReach, weights + count, std::greater<>());
    const float least = weights[CellBlend::kReach];
    // Keeps the cells in their order, since standard libraries partition differently.
    auto ties = CellBlend::kReach -
                std::count_if(weights, weights + CellBlend::kReach, [least](float weight) { return weight > least; });
    int kept = 0;
    for (int k = 0; k < count; ++k) {
      if (found[k].weight > least || (found[k].weight == least && ties-- > 0)) {
        found[kept] = found[k];
        found[kept++].weight -= least;  // so that dropped cells fade out without a step
      }
    }
    count = kept;
  }
  return count;
}

void Weigher::operator()(const Vector3& position, int cell, int* to, float* weights) const {
  constexpr double kFlat = 0.03;  // fraction of the spread: a direction with less is not along the surface
  constexpr float kTrace = 1e-12F;
  Reaching near[kRoom];
  int count = reaching(floats4(scale_ * (position - cells_.centres.row(cell).transpose())), cell, near);
  if (count == 0) {
    near[0] = {Four{}, 1, cell};
    count = 1;
  }
  Four mean = {};
  float sum = 0;
  for (int k = 0; k < count; ++k) {
    near[k].weight += kTrace;
    sum += near[k].weight;
    mean += near[k].weight * near[k].offset;
  }
  mean /= sum;
  Four spread[3] = {};
  for (int k = 0; k < count; ++k) {
    near[k].weight /= sum;
    near[k].offset -= mean;
    for (int row = 0; row < 3; ++row) {
      spread[row] += (near[k].weight * near[k].offset[row]) * near[k].offset;
    }
  }
  Matrix3 matrix;
  Vector3 middle;
  for (int row = 0; row < 3; ++row) {
    middle[row] = static_cast<double>(mean[row]);
    for (int column = 0; column < 3; ++column) {
      matrix(row, column) = static_cast<double>(spread[row][column]);
    }
  }
  const double size = matrix.trace();
  Four correction = {};
  if (size > 0) {
    matrix.diagonal().array() += kFlat * size;
    correction = floats4(Vector3(-(matrix.inverse() * middle)));
  }
  constexpr float kLeast = -0.5F, kMost = 2.5F;  // beyond these, the cells surround the position badly
  float total = 0;
  for (int k = 0; k < CellBlend::kReach; ++k) {
    const Reaching& from = near[k < count ? k : 0];
    const Four along = correction * from.offset;
    to[k] = from.cell;
    weights[k] = std::clamp(1 + along[0] + along[1] + along[2], kLeast, kMost);
    total += k < count ? weights[k] * from.weight : 0.0F;
  }
  // Adds the amount that clamping removed to all weights. Dividing by their sum could divide by nearly zero.
  for (int k = 0; k < CellBlend::kReach; ++k) {
    weights[k] = k < count ? (weights[k] + (1 - total)) * near[k].weight : 0.0F;
  }
}

}  // namespace

RegionCells make_cells(const Region& region, const Points& rest, int target, ThreadPool& pool) {
  RegionCells cells;
  const int count = pack_cells(region, rest, target, pool, cells.of);
  cells.centres = centroids(cells.of, rest, count, cells.vertices);
  reach_borders(region, rest, cells);
  CellSums(region, rest, cells, pool).take();
  measure_metric(size_of(rest, region.faces).size, cells);
  return cells;
}

CellBlend::CellBlend(const RegionCells& from, const Points& rest, ThreadPool& pool)
    : cells(kReach, rest.rows()), weights(kReach, rest.rows()) {
  const Weigher weigher(from, rest);
  constexpr int kGrain = 1024;
  for_indices(pool, static_cast<int>(rest.rows()), kGrain,
              [&](int i) { weigher(rest.row(i).transpose(), from.of[i], cells.col(i).data(), weights.col(i).data()); });
}

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
