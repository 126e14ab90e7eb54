// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/weld.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <utility>

#include "lapedit/base/progress.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit {
namespace {

std::uint64_t hash_of(const Points& vertices, int vertex) {
  std::uint64_t hash = 0;
  for (int k = 0; k < 3; ++k) {
    const double number = vertices(vertex, k) + 0.0;  // without negative zeros
    std::uint64_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15U;
    hash ^= hash >> 32U;
  }
  return hash;
}

}  // namespace

Weld::Weld(const Points& vertices) {
  const int n = static_cast<int>(vertices.rows());
  std::size_t size = 16;
  while (size < 2 * static_cast<std::size_t>(n)) {
    size *= 2;
  }
  std::vector<int> at(size, -1);  // an open hash table of vertices
  Checkpoints checkpoints;
  for (int v = 0; v < n; ++v) {
    checkpoints();
    if (!vertices.row(v).allFinite()) {
      continue;
    }
    std::size_t entry = hash_of(vertices, v) & (size - 1);
    while (at[entry] >= 0 && vertices.row(at[entry]) != vertices.row(v)) {
      entry = (entry + 1) & (size - 1);
    }
    if (at[entry] < 0) {
      at[entry] = v;
    } else {
      if (representative_.empty()) {
        representative_.resize(static_cast<std::size_t>(n));
        std::iota(representative_.begin(), representative_.end(), 0);
      }
      representative_[static_cast<std::size_t>(v)] = at[entry];
    }
  }
}

void Weld::to_representatives(std::vector<int>& vertices) const {
  for (int& v : vertices) {
    if (v >= 0 && v < static_cast<int>(representative_.size())) {
      v = representative(v);
    }
  }
}

std::vector<int> Weld::representatives(std::vector<int> vertices) const {
  to_representatives(vertices);
  return sorted_set(std::move(vertices));
}

Faces Weld::faces(const Faces& faces) const {
  return empty() ? faces : Faces(faces.unaryExpr([this](int v) { return representative(v); }));
}

void Weld::add_others(std::vector<int>& vertices, std::vector<int>& rows) const {
  rows.resize(vertices.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (empty()) {
    return;
  }
  std::vector<int> row_of(representative_.size(), -1);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    row_of[static_cast<std::size_t>(vertices[k])] = static_cast<int>(k);
  }
  vertices.clear();
  rows.clear();
  for (std::size_t v = 0; v < representative_.size(); ++v) {
    if (const int row = row_of[static_cast<std::size_t>(representative_[v])]; row >= 0) {
      vertices.push_back(static_cast<int>(v));
      rows.push_back(row);
    }
  }
}

void Weld::add_others(std::vector<int>& vertices, Points& positions) const {
  std::vector<int> rows;
  add_others(vertices, rows);
  if (rows.size() > static_cast<std::size_t>(positions.rows())) {
    positions = gather(positions, rows);
  }
}

std::shared_ptr<const Joined> joined_surface(const TriangleMesh& mesh) {
  Joined joined;
  joined.weld = Weld(mesh.vertices);
  joined.faces = joined.weld.faces(mesh.faces);
  if (!keep_distinct(joined.faces) && joined.weld.empty()) {
    return nullptr;
  }
  joined.adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), joined.faces);
  return std::make_shared<const Joined>(std::move(joined));
}

}  // namespace lapedit
