// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "base_support.h"
#include "lapedit/base/compressed_rows.h"
#include "lapedit/linear/linear.h"

/// Graphs and their Laplacians, made without the layers that use them.
namespace lapedit::support {

/// A graph with positions of its vertices.
struct Graph {
  Points points;
  std::vector<std::pair<int, int>> edges = {};  ///< in either direction, also several times

  int size() const { return static_cast<int>(points.rows()); }
  CompressedRows neighbours() const {
    std::vector<std::set<int>> rows(static_cast<std::size_t>(size()));
    for (const auto& [a, b] : edges) {
      if (a != b) {
        rows[a].insert(b);
        rows[b].insert(a);
      }
    }
    CompressedRows lists;
    for (const std::set<int>& row : rows) {
      lists.values.insert(lists.values.end(), row.begin(), row.end());
      lists.offsets.push_back(static_cast<int>(lists.values.size()));
    }
    return lists;
  }
};

enum class Surface { Plane, Tube, Torus };

/// A surface in triangles, vertex along * i + j. A tube closes around its first direction, a torus in both.
/// @param irregular  diagonals in random directions
inline Graph surface(Surface kind, int around, int along, bool irregular = false) {
  Graph graph{Points(static_cast<Eigen::Index>(around) * along, 3)};
  const double turn = 2 * std::acos(-1.0), radius = around / turn, ring = 2 * radius + along / turn;
  std::mt19937 random(3);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const double u = turn * i / around, v = turn * j / along, across = radius * std::cos(u);
      const int here = along * i + j, right = along * ((i + 1) % around) + j, up = along * i + (j + 1) % along,
                beyond = along * ((i + 1) % around) + (j + 1) % along;
      const bool has_right = i + 1 < around || kind != Surface::Plane, has_up = j + 1 < along || kind == Surface::Torus;
      if (kind == Surface::Plane) {
        graph.points.row(here) << i, j, 0;
      } else if (kind == Surface::Tube) {
        graph.points.row(here) << across, radius * std::sin(u), j;
      } else {
        graph.points.row(here) << (ring + across) * std::cos(v), (ring + across) * std::sin(v), radius * std::sin(u);
      }
      if (has_right) graph.edges.emplace_back(here, right);
      if (has_up) graph.edges.emplace_back(here, up);
      if (has_right && has_up) {
        graph.edges.push_back(irregular && random() % 2 == 0 ? std::pair(here, beyond) : std::pair(right, up));
      }
    }
  }
  return graph;
}

/// Vertices without edges.
inline Graph lone_vertices(int count) {
  return {Points::Zero(count, 3)};
}

/// Two graphs, one after the other in numbering.
inline Graph together(const Graph& a, const Graph& b) {
  Graph graph{Points(a.points.rows() + b.points.rows(), 3), a.edges};
  graph.points << a.points, b.points;
  for (const auto& [from, to] : b.edges) {
    graph.edges.emplace_back(a.size() + from, a.size() + to);
  }
  return graph;
}

/// A ring of vertices around the last one.
inline Graph wheel(int spokes) {
  Graph graph = together(surface(Surface::Tube, spokes, 1), lone_vertices(1));
  for (int k = 0; k < spokes; ++k) {
    graph.edges.emplace_back(spokes, k);
  }
  return graph;
}

/// The same graph: vertex v gets the number new_number[v].
inline Graph renumbered(Graph graph, const std::vector<int>& new_number) {
  const Points points = graph.points;
  for (int v = 0; v < graph.size(); ++v) {
    graph.points.row(new_number[v]) = points.row(v);
  }
  for (auto& [from, to] : graph.edges) {
    from = new_number[from];
    to = new_number[to];
  }
  return graph;
}

/// M = D^-1 L, L the Laplacian of symmetric weights.
struct TestOperator {
  SparseMatrix matrix;
  Eigen::VectorXd sums;  ///< D
};

/// @param uneven  weights between 0.5 and 1.5 instead of 1
inline TestOperator laplacian(const Graph& graph, bool uneven = false) {
  const CompressedRows neighbours = graph.neighbours();
  const int n = neighbours.rows();
  const auto weight = [uneven](int i, int j) { return uneven ? 1 + 0.5 * std::sin(13.0 * (i + j) + 7.0 * i * j) : 1; };
  TestOperator result = {SparseMatrix(n, n), Eigen::VectorXd::Zero(n)};
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    for (const int j : neighbours[i]) {
      result.sums[i] += weight(i, j);
    }
    for (const int j : neighbours[i]) {
      entries.emplace_back(i, j, -weight(i, j) / result.sums[i]);
    }
    if (neighbours[i].size() > 0) {
      entries.emplace_back(i, i, 1);
    }
  }
  result.matrix.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// The lower half of M^T M + 1/100, M the umbrella operator.
inline SparseMatrix system_of(const Graph& graph) {
  const SparseMatrix m = laplacian(graph).matrix;
  SparseMatrix identity(m.rows(), m.cols());
  identity.setIdentity();
  const SparseMatrix whole = SparseMatrix(m.transpose()) * m + 0.01 * identity;
  return whole.triangularView<Eigen::Lower>();
}

/// Entries of the factor of a matrix, given by its lower half, if it is eliminated in an order: the vertex order[k]
/// k-th.
inline double factor_entries(const SparseMatrix& lower, const std::vector<int>& order) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation(static_cast<Eigen::Index>(order.size()));
  std::copy(order.begin(), order.end(), permutation.indices().data());
  const SparseMatrix whole = lower.selfadjointView<Eigen::Lower>();
  SparseMatrix permuted;
  permuted = whole.twistedBy(permutation.transpose());
  // Along the elimination tree (Liu 1990).
  const int n = static_cast<int>(permuted.cols());
  std::vector<int> parent(n, -1), mark(n, -1);
  double entries = n;
  for (int j = 0; j < n; ++j) {
    mark[j] = j;
    for (SparseMatrix::InnerIterator entry(permuted, j); entry; ++entry) {
      for (int i = static_cast<int>(entry.row()); i < j && mark[i] != j; i = parent[i]) {
        if (parent[i] < 0) parent[i] = j;
        mark[i] = j;
        ++entries;
      }
    }
  }
  return entries;
}

/// The same over that of minimum degree.
inline double relative_fill(const Graph& graph, const std::vector<int>& order) {
  const SparseMatrix lower = system_of(graph);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> by_degree;
  Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), by_degree);
  const int* const first = by_degree.indices().data();
  return factor_entries(lower, order) / factor_entries(lower, {first, first + by_degree.size()});
}

inline Points random_points(Eigen::Index n, unsigned seed) {
  std::mt19937 random(seed);
  return Points::NullaryExpr(n, 3, [&] { return random() / 2147483648.0 - 1; });
}

}  // namespace lapedit::support
