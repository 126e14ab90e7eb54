// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "lapedit/mesh/vertex_set.h"

namespace lapedit::support {

/// Faces with x above a limit have vertices of their own, as islands of texture coordinates do: the mesh then has
/// several vertices at the same position.
inline TriangleMesh with_islands(const TriangleMesh& sound, double limit) {
  TriangleMesh torn = sound;
  std::map<int, int> doubled;
  std::vector<int> of;
  const auto is_beyond = [&](const auto& face) {
    return sound.vertices(face[0], 0) + sound.vertices(face[1], 0) + sound.vertices(face[2], 0) > 3 * limit;
  };
  for (const auto& face : sound.faces.rowwise()) {
    for (const int v : face) {
      if (!is_beyond(face)) doubled[v] = -1;
    }
  }
  const auto count = static_cast<int>(sound.vertices.rows());
  for (auto face : torn.faces.rowwise()) {
    const bool beyond = is_beyond(face);
    for (int& v : face) {
      if (const auto found = doubled.find(v); beyond && found != doubled.end()) {
        if (found->second < 0) {
          found->second = count + static_cast<int>(of.size());
          of.push_back(v);
        }
        v = found->second;
      }
    }
  }
  torn.vertices.conservativeResize(count + static_cast<Eigen::Index>(of.size()), 3);
  torn.vertices.bottomRows(static_cast<Eigen::Index>(of.size())) = gather(sound.vertices, of);
  return torn;
}

}  // namespace lapedit::support
