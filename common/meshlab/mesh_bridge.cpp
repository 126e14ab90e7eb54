// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/mesh_bridge.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/mesh/vertex_set.h"

namespace lapedit::host {
namespace {

/// Throws if a corner is not a vertex of the mesh. Corners may be any pointers, so only addresses are compared.
void require_vertex(const CMeshO& host, const CVertexO* corner, const char* kind, std::size_t number) {
  const auto size = static_cast<std::intptr_t>(sizeof(CVertexO));
  const auto count = static_cast<std::intptr_t>(host.vert.size());
  const auto off = reinterpret_cast<std::intptr_t>(corner) - reinterpret_cast<std::intptr_t>(host.vert.data());
  if (corner != nullptr && off % size == 0 && off / size >= 0 && off / size < count) {
    return;
  }
  const std::intptr_t named = off / size;
  const bool is_given = corner != nullptr && off % size == 0 && std::abs(named) <= std::numeric_limits<int>::max();
  throw EditError(ErrorCause::BadIndex,
                  std::string(kind) + " " + std::to_string(number) + " names " +
                      (is_given ? "vertex " + std::to_string(named) : std::string("a vertex outside the mesh")) +
                      ", but there are " + std::to_string(count) +
                      " vertices, counted from 0: correct the file that the mesh was read from.");
}

template <class Container>
Eigen::Index count_existing(const Container& all) {
  return std::count_if(all.begin(), all.end(), [](const auto& element) { return !element.IsD(); });
}

}  // namespace

Box3m finite_box(const CMeshO& host) {
  Box3m box;
  for (const CVertexO& vertex : host.vert) {
    if (!vertex.IsD() && is_finite(vertex.cP())) {
      box.Add(vertex.cP());
    }
  }
  return box;
}

void require_sound_corners(const CMeshO& host) {
  for (std::size_t f = 0; f < host.face.size(); ++f) {
    for (int k = 0; k < 3 && !host.face[f].IsD(); ++k) {
      require_vertex(host, host.face[f].cV(k), "Face", f);
    }
  }
  for (std::size_t e = 0; e < host.edge.size(); ++e) {
    for (int k = 0; k < 2 && !host.edge[e].IsD(); ++k) {
      require_vertex(host, host.edge[e].cV(k), "Edge", e);
    }
  }
}

BridgedMesh read_mesh(const CMeshO& host) {
  require_sound_corners(host);
  BridgedMesh bridged;
  Points& vertices = bridged.mesh.vertices;
  vertices.resize(count_existing(host.vert), 3);
  for (std::size_t index = 0; index < host.vert.size(); ++index) {
    const bool exists = !host.vert[index].IsD();
    const auto v = static_cast<int>(bridged.host_vertex.size());
    bridged.core_vertex.push_back(exists ? v : -1);
    if (exists) {
      bridged.host_vertex.push_back(static_cast<int>(index));
      vertices.row(v) = to_core(host.vert[index].cP()).transpose();
    }
  }
  Faces& faces = bridged.mesh.faces;
  faces.resize(count_existing(host.face), 3);
  Eigen::Index f = 0;
  for (const CFaceO& face : host.face) {
    for (int k = 0; k < 3 && !face.IsD(); ++k) {
      faces(f, k) = bridged.core_vertex[vcg::tri::Index(host, face.cV(k))];
    }
    f += face.IsD() ? 0 : 1;
  }
  return bridged;
}

std::vector<int> selected_vertices(const CMeshO& host, const std::vector<int>& core_vertex) {
  std::vector<int> selected;
  for (std::size_t v = 0; v < host.vert.size(); ++v) {
    if (!host.vert[v].IsD() && host.vert[v].IsS()) {
      selected.push_back(core_vertex[v]);
    }
  }
  return selected;
}

std::vector<int> selected_faces(const CMeshO& host) {
  std::vector<int> selected;
  int f = 0;
  for (const CFaceO& face : host.face) {
    if (!face.IsD() && face.IsS()) {
      selected.push_back(f);
    }
    f += face.IsD() ? 0 : 1;
  }
  return selected;
}

std::vector<int> vertices_of_selected_faces(const CMeshO& host, const std::vector<int>& core_vertex) {
  std::vector<int> vertices;
  for (const CFaceO& face : host.face) {
    for (int k = 0; k < 3 && !face.IsD() && face.IsS(); ++k) {
      vertices.push_back(core_vertex[vcg::tri::Index(host, face.cV(k))]);
    }
  }
  return sorted_set(std::move(vertices));
}

double finite_diagonal(const CMeshO& host) {
  const Box3m box = finite_box(host);
  return box.IsNull() ? 0 : (to_core(box.max) - to_core(box.min)).norm();
}

}  // namespace lapedit::host
