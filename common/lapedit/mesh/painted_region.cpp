// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/mesh/painted_region.h"

#include <algorithm>

namespace lapedit {

Region painted_region(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& vertices,
                      const std::vector<std::vector<int>>& groups) {
  Region region;
  region.mesh_vertex = vertices;
  region.mesh_vertices = static_cast<int>(mesh.vertices.rows());
  region.classes.assign(vertices.size(), VertexClass::Free);
  std::vector<int> position(mesh.vertices.rows(), 0);  // in the region, from 1
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    position[vertices[i]] = static_cast<int>(i) + 1;
  }
  const auto local = [&position](int v) { return position[v] - 1; };
  std::vector<int> corners;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (const int w : adjacency.neighbours[vertices[i]]) {
      if (local(w) < 0) {
        region.classes[i] = VertexClass::Anchor;
      }
    }
    for (const int f : adjacency.faces[vertices[i]]) {
      const int a = local(mesh.faces(f, 0));
      const int b = local(mesh.faces(f, 1));
      const int c = local(mesh.faces(f, 2));
      // Each face is listed once, by its lowest corner.
      if (a >= 0 && b >= 0 && c >= 0 && std::min({a, b, c}) == static_cast<int>(i)) {
        corners.insert(corners.end(), {a, b, c});
      }
    }
  }
  for (const std::vector<int>& group : groups) {
    for (const int v : group) {
      if (local(v) >= 0) {
        region.classes[local(v)] = VertexClass::Handle;
      }
    }
  }
  region.faces = Eigen::Map<const Faces>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return region;
}

int held_by_nothing(const Region& region) {
  std::vector<int> group(region.anchored.size(), -1);
  std::vector<char> held(region.anchored.begin(), region.anchored.end());
  for (int i = 0; i < region.size() && !region.anchored.empty(); ++i) {
    int& first = group[region.component[i]];
    held[region.component[i]] |= region.group[i] >= 0 && first >= 0 && region.group[i] != first;
    first = region.group[i] >= 0 ? region.group[i] : first;
  }
  int count = 0;
  for (const int c : region.component) {
    count += held[c] ? 0 : 1;
  }
  return count;
}

}  // namespace lapedit
