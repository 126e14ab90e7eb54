// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "lapedit/linear/linear.h"
#include "mesh_support.h"
#include "shapes.h"

/// Operators over the edges of meshes, made without the layers that use them.
namespace lapedit::support {

/// M = D^-1 L, L the Laplacian of symmetric weights.
struct TestOperator {
  SparseMatrix matrix;
  Eigen::VectorXd sums;  ///< D
};

/// @param uneven  weights between 0.5 and 1.5 in place of 1
inline TestOperator laplacian(const TriangleMesh& mesh, bool uneven = false) {
  const IndexLists neighbours = adjacency_of(mesh).neighbours;
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

}  // namespace lapedit::support
