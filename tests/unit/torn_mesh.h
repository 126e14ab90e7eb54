// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <numeric>
#include <vector>

#include "lapedit/mesh/vertex_set.h"

/// Meshes with several vertices at the same place.
namespace lapedit::support {

/// A mesh with vertices that others share their places with, and of each of its vertices the one of `sound` there.
struct Torn {
  TriangleMesh mesh, sound;
  std::vector<int> of;
};

/// Every triangle has corners of its own, as in an STL file.
inline Torn soup(const TriangleMesh& sound) {
  Torn torn{{}, sound, {}};
  for (Eigen::Index k = 0; k < sound.faces.size(); ++k) {
    torn.of.push_back(sound.faces.data()[k]);
  }
  torn.mesh.vertices = gather(sound.vertices, torn.of);
  torn.mesh.faces.resize(sound.faces.rows(), 3);
  std::iota(torn.mesh.faces.data(), torn.mesh.faces.data() + torn.mesh.faces.size(), 0);
  return torn;
}

/// Faces with x above and below a limit have vertices of their own, as islands of texture coordinates do.
inline Torn with_islands(const TriangleMesh& sound, double limit) {
  Torn torn{sound, sound, std::vector<int>(sound.vertices.rows())};
  std::iota(torn.of.begin(), torn.of.end(), 0);
  const auto is_beyond = [&](const auto& face) {
    return sound.vertices(face[0], 0) + sound.vertices(face[1], 0) + sound.vertices(face[2], 0) > 3 * limit;
  };
  std::vector<int> other(sound.vertices.rows(), -1);
  for (const auto& face : sound.faces.rowwise()) {
    for (const int v : face) {
      other[v] = is_beyond(face) ? other[v] : v;  // on this side
    }
  }
  std::vector<char> is_doubled(sound.vertices.rows(), 0);
  for (auto face : torn.mesh.faces.rowwise()) {
    const bool beyond = is_beyond(face);
    for (int& v : face) {
      if (beyond && other[v] >= 0 && !is_doubled[v]) {
        is_doubled[v] = 1;
        other[v] = static_cast<int>(torn.of.size());
        torn.of.push_back(v);
      }
      v = beyond && is_doubled[v] ? other[v] : v;
    }
  }
  torn.mesh.vertices = gather(sound.vertices, torn.of);
  return torn;
}

}  // namespace lapedit::support
