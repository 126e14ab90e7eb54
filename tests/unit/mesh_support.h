// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <vector>

#include "base_support.h"
#include "lapedit/mesh/adjacency.h"

/// A tube, renumbering and adjacency for tests with meshes.
namespace lapedit::support {

/// The same surface: vertex v gets the number new_number[v], faces another order and another first corner.
inline TriangleMesh renumbered(const TriangleMesh& mesh, const std::vector<int>& new_number, unsigned seed) {
  TriangleMesh result = mesh;
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    result.vertices.row(new_number[v]) = mesh.vertices.row(v);
  }
  const std::vector<int> new_face = shuffled(static_cast<int>(mesh.faces.rows()), seed);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      result.faces(new_face[f], (k + f) % 3) = new_number[mesh.faces(f, k)];
    }
  }
  return result;
}

inline std::vector<int> renumbered(std::vector<int> vertices, const std::vector<int>& new_number) {
  for (int& v : vertices) {
    v = new_number[v];
  }
  return vertices;
}

inline Adjacency adjacency_of(const TriangleMesh& mesh) {
  return build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
}

}  // namespace lapedit::support
