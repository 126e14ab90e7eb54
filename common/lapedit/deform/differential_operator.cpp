// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/differential_operator.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "lapedit/base/error.h"

namespace lapedit {
namespace {

constexpr double kEquilateralWeight = 0.57735026918962576;  // 1 / sqrt(3) = cot 60 degrees, both sides halved and added
constexpr double kLargestCotangent = 1e3;                   // a corner of 0.06 degrees
constexpr double kNoArea = 1e-10;                           // twice the area over the longest edge squared

Eigen::VectorXd sums_of(const Region& region, const std::vector<double>& weights) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(region.size());
  for (int j = 0; j < region.size(); ++j) {
    for (int k = region.neighbours.offsets[j]; k < region.neighbours.offsets[j + 1]; ++k) {
      sums[j] += weights[k];
    }
  }
  return sums;
}

/// M of the paper's equation (1) and section 3, from one non-negative weight w_ji per entry of region.neighbours:
/// m_jj = 1, m_ji = -alpha_ji = -w_ji / sum_k w_jk; each row with neighbours has a positive sum.
SparseMatrix from_weights(const Region& region, const std::vector<double>& weights, const Eigen::VectorXd& sums) {
  const IndexLists& neighbours = region.neighbours;
  Eigen::SparseMatrix<double, Eigen::RowMajor, int> rows(region.size(), region.size());
  rows.reserve(static_cast<Eigen::Index>(neighbours.values.size()) + region.size());
  for (int j = 0; j < region.size(); ++j) {
    rows.startVec(j);
    bool has_diagonal = neighbours[j].size() == 0;
    for (int k = neighbours.offsets[j]; k < neighbours.offsets[j + 1]; ++k) {
      const int i = neighbours.values[k];
      if (!has_diagonal && i > j) {
        rows.insertBack(j, j) = 1;
        has_diagonal = true;
      }
      rows.insertBack(j, i) = -weights[k] / sums[j];
    }
    if (!has_diagonal) {
      rows.insertBack(j, j) = 1;
    }
  }
  rows.finalize();
  return rows;
}

/// Geometry of a face whose area is large enough to define angles, per corner, with the lengths of the opposite edges.
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
  /// tan(angle / 2) = |a x b| / (|a| |b| + a . b)
  double half_tangent(int corner) const {
    return twice_area / (lengths[(corner + 1) % 3] * lengths[(corner + 2) % 3] + products[corner]);
  }
};

/// Adds the contributions of faces to their edges, in both directions.
class EdgeSums {
 public:
  explicit EdgeSums(const Region& region)
      : neighbours_(region.neighbours),
        sums_{std::vector<double>(neighbours_.values.size(), 0), std::vector<char>(neighbours_.values.size(), 0)},
        known_(neighbours_.values.size(), 0),
        local_(region.mesh_vertices, -1) {
    for (int i = 0; i < region.size(); ++i) {
      local_[region.mesh_vertex[i]] = i;
    }
  }

  /// @param a,b  mesh vertices, of which an edge is one of the region only if both are. @param usable  the face
  void add(int a, int b, bool usable, double weight) {
    const int i = local_[a], j = local_[b];
    if (i < 0 || j < 0 || i == j) {
      return;
    }
    for (const int e : {neighbours_.entry(i, j), neighbours_.entry(j, i)}) {
      known_[e] = 1;
      sums_.uniform[e] |= !usable;
      sums_.values[e] += usable ? weight : 0;
    }
  }

  EdgeWeights take() {
    for (std::size_t e = 0; e < known_.size(); ++e) {
      sums_.uniform[e] |= !known_[e];
    }
    return std::move(sums_);
  }

 private:
  const IndexLists& neighbours_;
  EdgeWeights sums_;
  std::vector<char> known_;
  std::vector<int> local_;  // of a mesh vertex
};

/// w_ji = (cot a + cot b) / 2, a and b the angles opposite to edge ji.
EdgeWeights cotangent_weights(const Region& region, const TriangleMesh& mesh) {
  const IndexLists& neighbours = region.neighbours;
  EdgeSums sums(region);
  for (const int face : region.edge_faces) {
    const Angles angles(mesh, face);
    for (int k = 0; k < 3; ++k) {
      sums.add(mesh.faces(face, (k + 1) % 3), mesh.faces(face, (k + 2) % 3), angles.usable, 0.5 * angles.cotangent(k));
    }
  }
  EdgeWeights result = sums.take();
  std::vector<double>& weights = result.values;
  std::vector<char>& uniform = result.uniform;
  for (std::size_t e = 0; e < weights.size(); ++e) {
    weights[e] = uniform[e] ? kEquilateralWeight : std::max(weights[e], 0.0);
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
      uniform[e] = 1;
    }
  }
  return result;
}

/// Both directions of each edge take the larger weight.
void make_symmetric(const IndexLists& neighbours, std::vector<double>& weights) {
  for (int i = 0; i + 1 < static_cast<int>(neighbours.offsets.size()); ++i) {
    for (int e = neighbours.offsets[i]; e < neighbours.offsets[i + 1]; ++e) {
      if (const int j = neighbours.values[e]; i < j) {
        double& back = weights[neighbours.entry(j, i)];
        weights[e] = back = std::max(weights[e], back);
      }
    }
  }
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

/// Returns half the tangents of half the angles next to an edge, over its length.
EdgeWeights mean_value_weights(const Region& region, const TriangleMesh& mesh) {
  constexpr double kRange = 1e3;
  EdgeSums sums(region);
  const double unit = mean_edge(region, mesh);
  for (const int face : region.edge_faces) {
    const Angles angles(mesh, face);
    const double half[3] = {angles.half_tangent(0), angles.half_tangent(1), angles.half_tangent(2)};
    for (int k = 0; k < 3; ++k) {
      const int one = (k + 1) % 3, other = (k + 2) % 3;
      sums.add(mesh.faces(face, one), mesh.faces(face, other), angles.usable,
               0.5 * (half[one] + half[other]) * unit / angles.lengths[k]);
    }
  }
  // Of two equilateral triangles at an edge: tan 30 degrees twice, over the length; each corner and side contributes a
  // quarter.
  constexpr double kUniform = 2 * kEquilateralWeight;
  EdgeWeights result = sums.take();
  for (std::size_t e = 0; e < result.values.size(); ++e) {
    result.values[e] =
        result.uniform[e] ? kUniform : std::clamp(result.values[e], kUniform / kRange, kUniform * kRange);
  }
  return result;
}

/// Links have no triangles, and rows of their own hold them (link_rows.h). Here they keep pieces from having no
/// neighbour at all.
void weaken_links(const Region& region, EdgeWeights& weights) {
  constexpr double kLink = 0.03;
  for (const auto& [i, j] : region.links) {
    for (const int e : {region.neighbours.entry(i, j), region.neighbours.entry(j, i)}) {
      weights.values[e] *= kLink;
      if (!weights.uniform.empty()) {
        weights.uniform[e] = 0;
      }
    }
  }
}

}  // namespace

const char* name(LaplacianKind kind) {
  constexpr const char* kNames[] = {"umbrella", "cotangent", "mean value"};
  return kNames[static_cast<int>(kind)];
}

EdgeWeights edge_weights(LaplacianKind kind, const Region& region, const TriangleMesh& mesh, bool symmetric) {
  EdgeWeights weights;
  switch (kind) {
    case LaplacianKind::Umbrella:
      weights.values.assign(region.neighbours.values.size(), 1);
      break;
    case LaplacianKind::Cotangent:
      weights = cotangent_weights(region, mesh);
      break;
    case LaplacianKind::MeanValue:
      weights = mean_value_weights(region, mesh);
      break;
  }
  weaken_links(region, weights);
  if (symmetric && kind != LaplacianKind::Umbrella) {
    make_symmetric(region.neighbours, weights.values);
  }
  return weights;
}

DifferentialOperator differential_operator(LaplacianKind kind, const Region& region, const TriangleMesh& mesh,
                                           bool symmetric) {
  const EdgeWeights weights = edge_weights(kind, region, mesh, symmetric);
  const IndexLists& neighbours = region.neighbours;
  const auto is_uniform = [&](int from, int to) { return weights.uniform[neighbours.entry(from, to)]; };
  DifferentialOperator result;
  result.sums = sums_of(region, weights.values);
  result.matrix = from_weights(region, weights.values, result.sums);
  for (int j = 0; !weights.uniform.empty() && j < region.size(); ++j) {
    for (int e = neighbours.offsets[j]; e < neighbours.offsets[j + 1]; ++e) {
      const int other = neighbours.values[e];
      result.uniform_edges += j < other && (weights.uniform[e] || is_uniform(other, j));
    }
  }
  return result;
}

SparseMatrix power(const SparseMatrix& matrix, int order) {
  if (order < 1 || order > 3) {
    throw EditError(ErrorCause::BadParameter,
                    "The order of the Laplacian is " + std::to_string(order) + ": it can be 1, 2 or 3.");
  }
  SparseMatrix result = matrix;
  for (int k = 1; k < order; ++k) {
    result = SparseMatrix(result * matrix);
  }
  return result;
}

}  // namespace lapedit
