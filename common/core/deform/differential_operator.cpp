// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/differential_operator.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>

#include "lapedit/base/progress.h"
#include "lapedit/base/refuse.h"
#include "lapedit/deform/intrinsic_triangulation.h"
#include "lapedit/mesh/surface_index.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

constexpr double kEquilateralWeight = 0.57735026918962576;  // 1 / sqrt(3) = cot 60 degrees: half of it from each side
constexpr double kLargestCotangent = 1e3;                   // a corner of 0.06 degrees
constexpr double kNoArea = 1e-10;                           // twice the area over the longest edge squared

Eigen::VectorXd sums_of(const EdgeWeights& weights) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(weights.neighbours.rows());
  for (int j = 0; j < weights.neighbours.rows(); ++j) {
    for (int k = weights.neighbours.offsets[j]; k < weights.neighbours.offsets[j + 1]; ++k) {
      sums[j] += weights.values[k];
    }
  }
  return sums;
}

/// Returns D of LaplacianKind::Surface.
Eigen::VectorXd divisor_of(const Eigen::VectorXd& areas, const Eigen::VectorXd& sums) {
  constexpr double kMost = 1e3;  // with a bound of 200 needles move a result by 6 %, with 1000 by 0.5 %
  return (16 / squared_spacing(areas.mean()) * areas + (sums / kMost).cwiseAbs2()).cwiseSqrt();
}

/// Returns M of Lipman et al. 2004, equation (1) and section 3, from non-negative weights: m_ji = -w_ji / D_j.
SparseMatrix from_weights(const EdgeWeights& weights, const Eigen::VectorXd& sums, const Eigen::VectorXd& divisor) {
  const CompressedRows& neighbours = weights.neighbours;
  Eigen::SparseMatrix<double, Eigen::RowMajor, int> rows(neighbours.rows(), neighbours.rows());
  rows.reserve(static_cast<Eigen::Index>(neighbours.values.size()) + neighbours.rows());
  Checkpoints checkpoints;
  for (int j = 0; j < neighbours.rows(); ++j) {
    checkpoints();
    rows.startVec(j);
    bool has_diagonal = neighbours[j].size() == 0;
    for (int k = neighbours.offsets[j]; k < neighbours.offsets[j + 1]; ++k) {
      const int i = neighbours.values[k];
      if (!has_diagonal && i > j) {
        rows.insertBack(j, j) = sums[j] / divisor[j];
        has_diagonal = true;
      }
      rows.insertBack(j, i) = -weights.values[k] / divisor[j];
    }
    if (!has_diagonal) {
      rows.insertBack(j, j) = sums[j] / divisor[j];
    }
  }
  rows.finalize();
  return rows;
}

/// The angles of a face whose area is large enough to define them, per corner, and the lengths of the opposite edges.
struct Angles {
  bool usable = false;  ///< false also if a corner is NaN
  double twice_area = 0;
  double products[3] = {};  ///< a . b of the two edges at a corner
  double lengths[3] = {};

  Angles(const TriangleMesh& mesh, int face) {
    Vector3 edges[3];
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      edges[k] = (mesh.vertices.row(mesh.faces(face, (k + 2) % 3)) - mesh.vertices.row(mesh.faces(face, (k + 1) % 3)))
                     .transpose();
      const double squared = edges[k].squaredNorm();
      lengths[k] = std::sqrt(squared);
      longest = std::max(longest, squared);
    }
    twice_area = edges[0].cross(edges[1]).norm();
    usable = twice_area > kNoArea * longest;
    for (int k = 0; k < 3; ++k) {
      products[k] = -edges[(k + 1) % 3].dot(edges[(k + 2) % 3]);
    }
  }
  double cotangent(int corner) const {
    return std::clamp(products[corner] / twice_area, -kLargestCotangent, kLargestCotangent);
  }
  /// Returns tan(angle / 2) = |a x b| / (|a| |b| + a . b).
  double half_tangent(int corner) const {
    return twice_area / (lengths[(corner + 1) % 3] * lengths[(corner + 2) % 3] + products[corner]);
  }
};

/// Calls use(e, b) for each edge, where e is its entry in the row of the lower vertex and b that in the row of the
/// higher one. Rows are ascending, so each row lists its lower vertices first, in the order of this loop.
template <class Use>
void each_edge(const CompressedRows& neighbours, const Use& use) {
  std::vector<int> next(neighbours.offsets.begin(), neighbours.offsets.end() - 1);
  for (int i = 0; i < neighbours.rows(); ++i) {
    for (int e = next[i]; e < neighbours.offsets[i + 1]; ++e) {
      use(e, next[neighbours.values[e]]++);
    }
  }
}

/// Returns the sums of the weights that faces contribute to the edges of a region.
/// @param weigh  function: the contribution of a face, from its Angles, to the edge opposite to a corner
template <class Weigh>
EdgeWeights sums_over_faces(const Region& region, const TriangleMesh& mesh, const Weigh& weigh) {
  std::vector<int> local(region.mesh_vertices, -1);  // index in the region, per mesh vertex
  for (int i = 0; i < region.size(); ++i) {
    local[region.mesh_vertex[i]] = i;
  }
  const std::size_t count = region.neighbours.values.size();
  constexpr char kNoFace = 2;
  EdgeWeights sums{region.neighbours, std::vector<double>(count, 0), std::vector<char>(count, kNoFace)};
  Checkpoints checkpoints;
  for (const int face : region.edge_faces) {
    checkpoints();
    const Angles angles(mesh, face);
    for (int k = 0; k < 3; ++k) {
      const int i = local[mesh.faces(face, (k + 1) % 3)], j = local[mesh.faces(face, (k + 2) % 3)];
      if (i >= 0 && j >= 0 && i != j) {
        const int e = region.neighbours.entry(std::min(i, j), std::max(i, j));
        sums.values[e] += angles.usable ? weigh(angles, k) : 0;
        sums.uniform[e] = (sums.uniform[e] == 1 || !angles.usable) ? 1 : 0;
      }
    }
  }
  each_edge(region.neighbours, [&sums](int e, int back) {
    sums.values[back] = sums.values[e];
    sums.uniform[back] = sums.uniform[e] = sums.uniform[e] != 0 ? 1 : 0;
  });
  return sums;
}

/// Returns w_ji = max(0, (cot a + cot b) / 2), where a and b are the angles opposite to edge ji.
EdgeWeights cotangent_weights(const Region& region, const TriangleMesh& mesh) {
  const CompressedRows& neighbours = region.neighbours;
  EdgeWeights result =
      sums_over_faces(region, mesh, [](const Angles& angles, int corner) { return 0.5 * angles.cotangent(corner); });
  std::vector<double>& weights = result.values;
  for (std::size_t e = 0; e < weights.size(); ++e) {
    weights[e] = result.uniform[e] ? kEquilateralWeight : std::max(weights[e], 0.0);
  }
  // A row whose weights all vanish becomes a row of the umbrella operator.
  constexpr double kNoWeight = 1e-9;
  for (int j = 0; j < region.size(); ++j) {
    double largest = 0;
    for (int e = neighbours.offsets[j]; e < neighbours.offsets[j + 1]; ++e) {
      largest = std::max(largest, weights[e]);
    }
    for (int e = neighbours.offsets[j]; largest < kNoWeight && e < neighbours.offsets[j + 1]; ++e) {
      weights[e] = kEquilateralWeight;
    }
  }
  return result;
}

/// Sets both directions of each edge to the larger of their weights.
void make_symmetric(const CompressedRows& neighbours, std::vector<double>& weights) {
  each_edge(neighbours,
            [&weights](int e, int back) { weights[e] = weights[back] = std::max(weights[e], weights[back]); });
}

double mean_edge(const Region& region, const TriangleMesh& mesh) {
  double sum = 0;
  for (int i = 0; i < region.size(); ++i) {
    for (const int j : region.neighbours[i]) {
      const double length =
          (mesh.vertices.row(region.mesh_vertex[i]) - mesh.vertices.row(region.mesh_vertex[j])).norm();
      sum += std::isfinite(length) ? length : 0;
    }
  }
  return sum > 0 ? sum / static_cast<double>(region.neighbours.values.size()) : 1;
}

/// Returns mean value weights (Floater 2003), averaged over both ends of an edge: half the sum of tan(angle / 2) over
/// the four angles next to it, over its length in mean edges.
EdgeWeights mean_value_weights(const Region& region, const TriangleMesh& mesh) {
  constexpr double kRange = 1e3;
  const double unit = mean_edge(region, mesh);
  // The edge between two equilateral triangles has 2 tan 30 degrees over its length; each of the four angles
  // contributes a quarter.
  constexpr double kUniform = 2 * kEquilateralWeight;
  EdgeWeights result = sums_over_faces(region, mesh, [unit](const Angles& angles, int corner) {
    const double one = angles.half_tangent((corner + 1) % 3), other = angles.half_tangent((corner + 2) % 3);
    return 0.5 * (one + other) * unit / angles.lengths[corner];
  });
  for (std::size_t e = 0; e < result.values.size(); ++e) {
    result.values[e] =
        result.uniform[e] ? kUniform : std::clamp(result.values[e], kUniform / kRange, kUniform * kRange);
  }
  return result;
}

/// Weakens links, which have no triangles. Separate rows constrain them (link_strengths()); the weak weights only
/// connect pieces that have no other neighbour.
void weaken_links(const Region& region, EdgeWeights& weights) {
  constexpr double kLink = 0.03;
  for (const auto& [i, j] : region.links) {
    for (const int e : {weights.neighbours.entry(i, j), weights.neighbours.entry(j, i)}) {
      weights.values[e] *= kLink;
    }
  }
}

EdgeWeights surface_weights(const Region& region, const Points& rest, const std::vector<Matrix3>* metric) {
  const SurfaceLaplacian surface = surface_laplacian(rest, region.faces, metric);
  std::vector<char> has_face(region.neighbours.values.size(), 0);
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      for (const int other : {(k + 1) % 3, (k + 2) % 3}) {
        has_face[region.neighbours.entry(region.faces(f, k), region.faces(f, other))] = 1;
      }
    }
  }
  EdgeWeights result;
  std::vector<std::pair<int, double>> row;
  for (int i = 0; i < region.size(); ++i) {
    row.clear();
    for (int k = surface.neighbours.offsets[i]; k < surface.neighbours.offsets[i + 1]; ++k) {
      row.emplace_back(surface.neighbours.values[k], surface.weights[k]);
    }
    for (int e = region.neighbours.offsets[i]; e < region.neighbours.offsets[i + 1]; ++e) {
      if (has_face[e] == 0) {
        row.emplace_back(region.neighbours.values[e], kEquilateralWeight);
      }
    }
    std::stable_sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    row.erase(std::unique(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
              row.end());
    for (const auto& [to, weight] : row) {
      result.neighbours.values.push_back(to);
      result.values.push_back(weight);
    }
    result.neighbours.offsets.push_back(static_cast<int>(result.values.size()));
  }
  const auto with_area = (surface.areas.array() > 0).count();
  const double mean = with_area > 0 ? surface.areas.sum() / static_cast<double>(with_area) : 1;
  result.areas = (surface.areas.array() > 0).select(surface.areas, mean);
  weaken_links(region, result);
  return result;
}

}  // namespace

const char* name(LaplacianKind kind) {
  constexpr const char* kNames[] = {"umbrella", "cotangent", "mean_value", "surface"};
  return kNames[static_cast<int>(kind)];
}

EdgeWeights edge_weights(LaplacianKind kind, const Region& region, const TriangleMesh& mesh, bool symmetric,
                         const std::vector<Matrix3>* metric) {
  EdgeWeights weights;
  switch (kind) {
    case LaplacianKind::Umbrella:
      weights = {region.neighbours, std::vector<double>(region.neighbours.values.size(), 1), {}};
      break;
    case LaplacianKind::Cotangent:
      weights = cotangent_weights(region, mesh);
      break;
    case LaplacianKind::MeanValue:
      weights = mean_value_weights(region, mesh);
      break;
    case LaplacianKind::Surface:
      return surface_weights(region, gather(mesh.vertices, region.mesh_vertex), metric);
  }
  weaken_links(region, weights);
  if (symmetric && kind != LaplacianKind::Umbrella) {
    make_symmetric(region.neighbours, weights.values);
  }
  return weights;
}

DifferentialOperator differential_operator(LaplacianKind kind, const Region& region, const TriangleMesh& mesh,
                                           bool symmetric, const std::vector<Matrix3>* metric) {
  return differential_operator(kind, edge_weights(kind, region, mesh, symmetric, metric));
}

DifferentialOperator differential_operator(LaplacianKind kind, const EdgeWeights& weights) {
  const Eigen::VectorXd sums = sums_of(weights);
  DifferentialOperator result;
  result.divisor = kind == LaplacianKind::Surface ? divisor_of(weights.areas, sums) : sums;
  result.mean = kind == LaplacianKind::Surface ? kMeanDivisor : sums.mean();
  result.matrix = from_weights(weights, sums, result.divisor);
  return result;
}

/// Multiplies some columns at a time, so that the work can be cancelled.
SparseMatrix product(const SparseMatrix& a, const SparseMatrix& b) {
  constexpr Eigen::Index kColumns = 4096;
  SparseMatrix result(a.rows(), b.cols());
  for (Eigen::Index first = 0; first < b.cols(); first += kColumns) {
    const SparseMatrix columns = a * b.middleCols(first, std::min(kColumns, b.cols() - first));
    if (first == 0) {
      constexpr double kMore = 1.1;
      const double blocks = static_cast<double>(b.cols()) / static_cast<double>(columns.cols());
      result.reserve(static_cast<Eigen::Index>(kMore * blocks * static_cast<double>(columns.nonZeros())));
    }
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
      result.startVec(first + j);
      for (SparseMatrix::InnerIterator entry(columns, j); entry; ++entry) {
        result.insertBack(entry.row(), first + j) = entry.value();
      }
    }
    checkpoint();
  }
  result.finalize();
  return result;
}

SparseMatrix power(const SparseMatrix& matrix, int order) {
  SparseMatrix result = matrix;
  for (int k = 1; k < order; ++k) {
    result = product(result, matrix);
  }
  return result;
}

void refuse_fans(const Region& region, int order, int longest) {
  constexpr int kFan = 256;                            // neighbours
  constexpr double kMost = 1e7, kMostPerVertex = 300;  // entries; each takes some 45 bytes, with the factor
  double entries = 0;
  int largest = 0;
  for (int i = 0; i < region.size(); ++i) {
    const double count = region.neighbours[i].size();
    if (count > kFan) {
      entries += count > longest ? region.size() : count * count * order * order;
      largest = count > region.neighbours[largest].size() ? i : largest;
    }
  }
  if (entries > kMost + kMostPerVertex * region.size()) {
    const int vertex = region.mesh_vertex[largest];
    refuse_edit(ErrorCause::BadParameter, {{}, vertex}, "Vertex ", vertex, " has ", region.neighbours[largest].size(),
                " neighbours. With such fans of triangles the equations of order ", order, " have about ", entries,
                " entries, which is too much memory: ", (order > 1 ? "use order 1, " : ""),
                "remesh the fans (in MeshLab: Isotropic Explicit Remeshing), or give a region without them.");
  }
}

double membrane_factor(double membrane, const Region& region, const Points& rest, double mean) {
  if (membrane == 0 || region.faces.rows() == 0 || !(mean > 0)) {
    return 0;
  }
  const SurfaceSize surface = size_of(rest, region.faces);
  const double squared_h = squared_spacing(face_areas(rest, region.faces).sum() / region.size());
  const double factor = std::min(membrane * (squared_h / 4) / (surface.size * surface.size), 1.0) / mean;
  return std::isfinite(factor) ? factor : 0;
}

}  // namespace lapedit
