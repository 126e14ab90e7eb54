// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <vector>

#include "base_support.h"
#include "lapedit/mesh/adjacency.h"

/// A tube, renumbering and adjacency for tests with meshes.
namespace lapedit::support {

/// A tube of radius 1 along x from 0 on, open at both ends. @param around  vertices of each ring
inline TriangleMesh open_tube(int around, int rings, double length) {
  TriangleMesh mesh;
  mesh.vertices.resize(Eigen::Index{around} * rings, 3);
  mesh.faces.resize(Eigen::Index{2} * around * (rings - 1), 3);
  for (int r = 0; r < rings; ++r) {
    for (int a = 0; a < around; ++a) {
      const int here = r * around + a, next = r * around + (a + 1) % around;
      const double angle = 2 * std::acos(-1.0) * a / around;
      mesh.vertices.row(here) << length * r / (rings - 1), std::cos(angle), std::sin(angle);
      if (r + 1 < rings) {
        mesh.faces.row(Eigen::Index{2} * here) << here, next, here + around;
        mesh.faces.row(Eigen::Index{2} * here + 1) << next, next + around, here + around;
      }
    }
  }
  return mesh;
}

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
