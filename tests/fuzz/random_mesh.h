// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "fuzz.h"
#include "shapes.h"

namespace lapedit::fuzz {

inline int vertex_count(const TriangleMesh& mesh) {
  return static_cast<int>(mesh.vertices.rows());
}

/// Faces between any vertices, with all that scans do not have.
inline TriangleMesh soup(Choices& choose) {
  TriangleMesh mesh;
  mesh.vertices.resize(1 + choose.below(30), 3);
  for (Eigen::Index k = 0; k < mesh.vertices.size(); ++k) mesh.vertices.data()[k] = choose.real();
  mesh.faces.resize(1 + choose.below(40), 3);
  for (Eigen::Index k = 0; k < mesh.faces.size(); ++k) mesh.faces.data()[k] = choose.below(vertex_count(mesh));
  return mesh;
}

inline TriangleMesh plain_mesh(Choices& choose) {
  const int kind = choose.below(12);
  const int a = 2 + choose.below(10), b = 2 + choose.below(10);
  if (kind == 0) return shapes::icosphere(choose.below(2));
  if (kind == 1) return shapes::cylinder(2 + a, b);
  if (kind == 2) return shapes::bar(1 + a % 4, 1 + b % 4, 1 + choose.below(3));
  if (kind == 3) return shapes::two_pieces(choose.below(2));
  if (kind == 4) return shapes::degenerate_grid(2 + a, 2 + b);
  if (kind == 5) return shapes::non_manifold_grid(2 + a, 2 + b);
  if (kind == 6) return shapes::inconsistent_grid(a, b);
  if (kind == 7) return shapes::letter_field(a, b);
  if (kind == 8) return soup(choose);
  return kind == 9 ? shapes::icosphere(2) : shapes::grid(a, b);
}

/// Of 1 to 200 vertices in single precision, some of them moved.
inline TriangleMesh random_mesh(Choices& choose) {
  TriangleMesh mesh = plain_mesh(choose);
  const int moved = choose.below(8);
  for (int k = 0; k < moved; ++k) {
    const int vertex = choose.index(vertex_count(mesh)), axis = choose.below(4);
    mesh.vertices(vertex, axis % 3) = axis == 3 ? std::numeric_limits<double>::quiet_NaN() : choose.real();
  }
  mesh.vertices = mesh.vertices.cast<float>().cast<double>().eval();
  return mesh;
}

/// A few vertices, seldom one that does not exist.
inline std::vector<int> random_vertices(Choices& choose, const TriangleMesh& mesh) {
  std::vector<int> vertices;
  const int n = vertex_count(mesh), kind = choose.below(32);
  if (kind == 0) return {n};
  if (kind == 1) {
    for (int v = choose.index(n); v < n; ++v) vertices.push_back(v);
    return vertices;
  }
  for (int k = kind % 5; k >= 0; --k) vertices.push_back(choose.index(n));
  return vertices;
}

inline bool same_bits(const Points& a, const Points& b) {
  return a.rows() == b.rows() && (a.size() == 0 || std::memcmp(a.data(), b.data(), sizeof(double) * a.size()) == 0);
}

}  // namespace lapedit::fuzz
