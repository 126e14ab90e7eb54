// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/region_cells.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lapedit {
namespace {

constexpr int kPieces = 16;  // sums are taken in so many parts, whatever the threads
constexpr int kRecentrings = 2;

/// Calls body(piece, first, last) for kPieces parts of [0, count).
template <class Body>
void in_parts(ThreadPool& pool, Eigen::Index count, const Body& body) {
  pool.each(kPieces, [&](int piece) { body(piece, count * piece / kPieces, count * (piece + 1) / kPieces); });
}

// --- Seeds and growth ------------------------------------------------------------------------------------------------

/// Vertices that begin a cell, spread along the numbering of the vertices: as many in a stretch of it as its share of
/// the density (d / d_max + 0.2)^-1.
std::vector<int> spread_seeds(const Region& region, int target) {
  constexpr double kSoft = 0.2, kStart = 0.5;
  const int n = region.size();
  const double scale = region.max_distance > 0 ? 1 / region.max_distance : 0;
  const auto density = [&](int i) { return 1 / (std::min(region.distance[i] * scale, 1.0) + kSoft); };
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    sum += density(i);
  }
  std::vector<int> group_size(1 + *std::max_element(region.group.begin(), region.group.end()), 0);
  for (const int g : region.group) {
    group_size[g >= 0 ? g : 0] += g >= 0;
  }
  std::vector<int> seeds;
  double due = kStart;
  for (int i = 0; i < n; ++i) {
    due += std::min(1.0, density(i) * target / sum);
    const bool alone = region.group[i] >= 0 && group_size[region.group[i]] == 1;
    if (due >= 1 || alone) {
      due -= due >= 1 ? 1 : 0;
      seeds.push_back(i);
    }
  }
  return seeds;
}

/// Rings around all seeds at a time; what they do not reach gets seeds of its own.
void grow(const Region& region, std::vector<int>& seeds, std::vector<int>& of, std::vector<int>& queue) {
  const int n = region.size();
  of.assign(n, -1);
  queue.clear();
  for (std::size_t c = 0; c < seeds.size(); ++c) {
    of[seeds[c]] = static_cast<int>(c);
    queue.push_back(seeds[c]);
  }
  std::size_t head = 0;
  for (int next = 0;;) {
    for (; head < queue.size(); ++head) {
      const int v = queue[head], cell = of[v];
      for (const int w : region.neighbours[v]) {
        if (of[w] < 0) {
          of[w] = cell;
          queue.push_back(w);
        }
      }
    }
    while (next < n && of[next] >= 0) {
      ++next;
    }
    if (next == n) {
      return;
    }
    of[next] = static_cast<int>(seeds.size());
    seeds.push_back(next);
    queue.push_back(next);
  }
}

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

/// Moves seeds to the middle of their cells, but those at a lone handle vertex.
void recentre(const Region& region, const Points& rest, const RegionCells& cells, std::vector<int>& seeds) {
  std::vector<double> nearest(seeds.size(), std::numeric_limits<double>::infinity());
  for (std::size_t c = 0; c < seeds.size(); ++c) {
    if (region.classes[seeds[c]] == VertexClass::Handle) {
      nearest[c] = -1;
    }
  }
  for (int i = 0; i < region.size(); ++i) {
    const int c = cells.of[i];
    const double distance = (rest.row(i) - cells.centres.row(c)).squaredNorm();
    if (distance < nearest[c]) {
      nearest[c] = distance;
      seeds[c] = i;
    }
  }
}

// --- Sums over cells -------------------------------------------------------------------------------------------------

/// Edges from one cell into another.
struct Crossing {
  int to;
  double weight;
  Vector3 flux;
};

/// What one part of the region's faces and edges adds to the cells.
struct PartialSums {
  std::vector<double> area, weight, mass;
  Points normals;
  std::vector<Symmetric> stiffness, diffusion;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::vector<Crossing>> crossing;  // per cell

  void clear(int count) {
    area.assign(count, 0);
    weight.assign(count, 0);
    mass.assign(count, 0);
    normals.setZero(count, 3);
    stiffness.assign(count, Symmetric::Zero());
    diffusion.assign(count, Symmetric::Zero());
    crossing.assign(count, {});
  }
  void cross(int from, int to, double of_edge, const Vector3& edge) {
    std::vector<Crossing>& list = crossing[from];
    auto known = std::find_if(list.begin(), list.end(), [to](const Crossing& entry) { return entry.to == to; });
    if (known == list.end()) {
      known = list.insert(known, {to, 0, Vector3::Zero()});
    }
    known->weight += of_edge;
    known->flux += of_edge * edge;
  }
};

class CellSums {
 public:
  CellSums(const Region& region, const Points& rest, const std::vector<double>& weights, RegionCells& cells,
           ThreadPool& pool)
      : region_(region), rest_(rest), weights_(weights), cells_(cells), pool_(pool) {}

  void take();

 private:
  void measure_density();
  void add_faces(PartialSums& to, Eigen::Index first, Eigen::Index last) const;
  void add_edges(PartialSums& to, Eigen::Index first, Eigen::Index last) const;
  void merge(std::vector<PartialSums>& parts);
  void merge_neighbours(std::vector<PartialSums>& parts);

  const Region& region_;
  const Points& rest_;
  const std::vector<double>& weights_;
  RegionCells& cells_;
  ThreadPool& pool_;
  std::vector<float> density_;  // 1 / sqrt(area_i / mean area), as the diffusion has it
};

void CellSums::measure_density() {
  constexpr double kSmall = 1e-3;
  const int n = region_.size();
  std::vector<double> sums(kPieces, 0);
  density_.resize(n);
  in_parts(pool_, n, [&](int piece, Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      double area = 0;
      for (const int j : region_.neighbours[static_cast<int>(i)]) {
        area += (rest_.row(j) - rest_.row(i)).squaredNorm();
      }
      density_[i] = static_cast<float>(area);
      sums[piece] += area;
    }
  });
  double mean = 0;
  for (const double sum : sums) {
    mean += sum / n;
  }
  in_parts(pool_, n, [&](int, Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      const double share = mean > 0 ? std::max(static_cast<double>(density_[i]) / mean, kSmall) : 1;
      density_[i] = static_cast<float>(1 / std::sqrt(share));
    }
  });
}

void CellSums::add_faces(PartialSums& to, Eigen::Index first, Eigen::Index last) const {
  for (Eigen::Index f = first; f < last; ++f) {
    int cell[3];
    Vector3 corner[3];
    for (int k = 0; k < 3; ++k) {
      cell[k] = cells_.of[region_.faces(f, k)];
      corner[k] = rest_.row(region_.faces(f, k)).transpose();
    }
    const Vector3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double share = normal.norm() / 6;
    for (int k = 0; k < 3; ++k) {
      to.normals.row(cell[k]) += normal.transpose();
      to.area[cell[k]] += share;
    }
    if (cell[0] != cell[1] && cell[1] != cell[2] && cell[2] != cell[0]) {
      std::sort(cell, cell + 3);
      to.triangles.push_back({cell[0], cell[1], cell[2]});
    }
  }
}

void CellSums::add_edges(PartialSums& to, Eigen::Index first, Eigen::Index last) const {
  const IndexLists& neighbours = region_.neighbours;
  for (Eigen::Index i = first; i < last; ++i) {
    const int own = cells_.of[i];
    Symmetric stiffness = Symmetric::Zero(), diffusion = Symmetric::Zero();
    double weight = 0, mass = 0;
    for (int k = neighbours.offsets[i]; k < neighbours.offsets[i + 1]; ++k) {
      const int j = neighbours.values[k];
      const Vector3 edge = (rest_.row(i) - rest_.row(j)).transpose();
      const Symmetric tensor = squared(edge);
      const double conductance = static_cast<double>(density_[i]) * static_cast<double>(density_[j]);
      stiffness += weights_[k] * tensor;
      diffusion += conductance * tensor;
      weight += weights_[k];
      mass += conductance * edge.squaredNorm();
      if (cells_.of[j] != own) {
        to.cross(own, cells_.of[j], weights_[k], edge);
      }
    }
    to.stiffness[own] += 0.5 * stiffness;
    to.diffusion[own] += 0.5 * diffusion;
    to.weight[own] += weight;
    to.mass[own] += 0.25 * mass;
  }
}

void CellSums::merge(std::vector<PartialSums>& parts) {
  const int m = cells_.count();
  cells_.area.assign(m, 0);
  cells_.weight.assign(m, 0);
  cells_.mass.assign(m, 0);
  cells_.normals.setZero(m, 3);
  cells_.stiffness.assign(m, Symmetric::Zero());
  cells_.diffusion.assign(m, Symmetric::Zero());
  for (const PartialSums& part : parts) {
    for (int c = 0; c < m; ++c) {
      cells_.area[c] += part.area[c];
      cells_.weight[c] += part.weight[c];
      cells_.mass[c] += part.mass[c];
      cells_.stiffness[c] += part.stiffness[c];
      cells_.diffusion[c] += part.diffusion[c];
    }
    cells_.normals += part.normals;
    cells_.triangles.insert(cells_.triangles.end(), part.triangles.begin(), part.triangles.end());
  }
  std::sort(cells_.triangles.begin(), cells_.triangles.end());
  cells_.triangles.erase(std::unique(cells_.triangles.begin(), cells_.triangles.end()), cells_.triangles.end());
  // Cells of obtuse or flat faces alone, where the operator has the umbrella's rows.
  constexpr double kLeast = 1e-6;
  for (int c = 0; c < m; ++c) {
    cells_.weight[c] = std::max(cells_.weight[c], kLeast * cells_.vertices[c]);
    cells_.mass[c] = std::max(cells_.mass[c], std::numeric_limits<double>::min());
  }
}

void CellSums::merge_neighbours(std::vector<PartialSums>& parts) {
  constexpr double kLeast = 1e-3;  // where cotangents cancel
  cells_.neighbours.offsets.assign(1, 0);
  std::vector<Crossing> all;
  std::vector<Vector3> flux;
  for (int c = 0; c < cells_.count(); ++c) {
    all.clear();
    for (PartialSums& part : parts) {
      all.insert(all.end(), part.crossing[c].begin(), part.crossing[c].end());
    }
    std::stable_sort(all.begin(), all.end(), [](const Crossing& a, const Crossing& b) { return a.to < b.to; });
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (k > 0 && all[k].to == all[k - 1].to) {
        cells_.crossing.back() += all[k].weight;
        flux.back() += all[k].flux;
      } else {
        cells_.neighbours.values.push_back(all[k].to);
        cells_.crossing.push_back(all[k].weight);
        flux.push_back(all[k].flux);
      }
    }
    cells_.neighbours.offsets.push_back(static_cast<int>(cells_.neighbours.values.size()));
  }
  cells_.flux.resize(static_cast<Eigen::Index>(flux.size()), 3);
  for (std::size_t k = 0; k < flux.size(); ++k) {
    cells_.flux.row(static_cast<Eigen::Index>(k)) = flux[k].transpose();
    cells_.crossing[k] = std::max(cells_.crossing[k], kLeast);
  }
}

void CellSums::take() {
  measure_density();
  std::vector<PartialSums> parts(kPieces);
  in_parts(pool_, region_.size(), [&](int piece, Eigen::Index first, Eigen::Index last) {
    parts[piece].clear(cells_.count());
    add_edges(parts[piece], first, last);
  });
  in_parts(pool_, region_.faces.rows(),
           [&](int piece, Eigen::Index first, Eigen::Index last) { add_faces(parts[piece], first, last); });
  merge(parts);
  merge_neighbours(parts);
}

// --- Blending --------------------------------------------------------------------------------------------------------

/// Each cell with its neighbours and theirs.
IndexLists two_rings(const RegionCells& cells) {
  IndexLists result;
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

/// Weights (1 - t^2 / T^2)^2 at the distances t, T that of the first cell left out, made to reproduce linear functions
/// of the cells' centres as far as those spread: w_k (1 + c (e_k - e)), e_k = C_k - p, e their mean, c = -S^-1 e.
class Weigher {
 public:
  explicit Weigher(const RegionCells& cells) : cells_(cells), rings_(two_rings(cells)) {}

  void operator()(const Vector3& place, int cell, std::array<int, CellBlend::kReach>& to,
                  std::array<float, CellBlend::kReach>& weights);

 private:
  const RegionCells& cells_;
  IndexLists rings_;
  std::vector<std::pair<double, int>> near_;
};

void Weigher::operator()(const Vector3& place, int cell, std::array<int, CellBlend::kReach>& to,
                         std::array<float, CellBlend::kReach>& weights) {
  constexpr int kReach = CellBlend::kReach;
  constexpr double kFlat = 0.03;  // of the spread: what counts as no direction of the surface
  near_.clear();
  for (const int c : rings_[cell]) {
    near_.emplace_back((cells_.centres.row(c).transpose() - place).squaredNorm(), c);
  }
  const int taken = std::min(kReach, static_cast<int>(near_.size()));
  double cutoff = 0;
  if (static_cast<int>(near_.size()) > kReach) {
    std::nth_element(near_.begin(), near_.begin() + kReach, near_.end());
    cutoff = near_[kReach].first;
  } else {
    cutoff = 2 * std::max_element(near_.begin(), near_.end())->first;
  }
  std::array<double, kReach> w = {};
  double sum = 0;
  Vector3 mean = Vector3::Zero();
  std::array<Vector3, kReach> e;
  for (int k = 0; k < taken; ++k) {
    const double rest = cutoff > 0 ? std::max(0.0, 1 - near_[k].first / cutoff) : 1;
    w[k] = rest * rest + 1e-12;
    sum += w[k];
    e[k] = cells_.centres.row(near_[k].second).transpose() - place;
    mean += w[k] * e[k];
  }
  mean /= sum;
  Matrix3 spread = Matrix3::Zero();
  for (int k = 0; k < taken; ++k) {
    e[k] -= mean;
    spread.noalias() += (w[k] / sum) * e[k] * e[k].transpose();
  }
  const double size = spread.trace();
  Vector3 correction = Vector3::Zero();
  if (size > 0) {
    spread.diagonal().array() += kFlat * size;
    correction = -(spread.inverse() * mean);
  }
  for (int k = 0; k < kReach; ++k) {
    to[k] = near_[k < taken ? k : 0].second;
    weights[k] = k < taken ? static_cast<float>(w[k] / sum * (1 + correction.dot(e[k]))) : 0.0F;
  }
}

}  // namespace

Symmetric squared(const Vector3& v) {
  Symmetric result;
  result << v[0] * v[0], v[0] * v[1], v[0] * v[2], v[1] * v[1], v[1] * v[2], v[2] * v[2];
  return result;
}

Matrix3 full_matrix(const Symmetric& s) {
  Matrix3 result;
  result << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  return result;
}

RegionCells make_cells(const Region& region, const Points& rest, const std::vector<double>& weights, int target,
                       ThreadPool& pool) {
  RegionCells cells;
  std::vector<int> seeds = spread_seeds(region, target), queue;
  queue.reserve(region.size());
  for (int round = 0;; ++round) {
    grow(region, seeds, cells.of, queue);
    cells.centres = centroids(cells.of, rest, static_cast<int>(seeds.size()), cells.vertices);
    if (round == kRecentrings) {
      break;
    }
    recentre(region, rest, cells, seeds);
  }
  CellSums(region, rest, weights, cells, pool).take();
  return cells;
}

CellBlend::CellBlend(const RegionCells& from, const Points& rest, ThreadPool& pool)
    : cells(from.of.size()), weights(from.of.size()) {
  const Weigher weigher(from);
  in_parts(pool, rest.rows(), [&](int, Eigen::Index first, Eigen::Index last) {
    Weigher own = weigher;
    for (Eigen::Index i = first; i < last; ++i) {
      own(rest.row(i).transpose(), from.of[i], cells[i], weights[i]);
    }
  });
}

}  // namespace lapedit
