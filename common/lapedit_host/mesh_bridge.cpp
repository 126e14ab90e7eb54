// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/mesh_bridge.h"

#include <QString>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/base/thread_pool.h"
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

/// Calls make_room(count) with the number of elements that are not deleted, then use(index, element, number) for each
/// element, where `number` counts the elements before it that are not deleted.
template <class Container, class MakeRoom, class Use>
void each_existing(ThreadPool& pool, const Container& all, const MakeRoom& make_room, const Use& use) {
  const auto chunks = static_cast<std::size_t>(pool.threads());
  const auto border = [&](std::size_t chunk) { return all.size() * chunk / chunks; };
  std::vector<int> starts(chunks + 1, 0);
  pool.each(pool.threads(), [&](int thread) {
    const auto chunk = static_cast<std::size_t>(thread);
    int count = 0;
    for (std::size_t index = border(chunk); index < border(chunk + 1); ++index) {
      count += all[index].IsD() ? 0 : 1;
    }
    starts[chunk + 1] = count;
  });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  make_room(starts.back());
  pool.each(pool.threads(), [&](int thread) {
    const auto chunk = static_cast<std::size_t>(thread);
    int number = starts[chunk];
    for (std::size_t index = border(chunk); index < border(chunk + 1); ++index) {
      use(index, all[index], number);
      number += all[index].IsD() ? 0 : 1;
    }
  });
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
  constexpr std::size_t kWorthThreads = 16384;
  ThreadPool pool(host.vert.size() >= kWorthThreads ? 0 : 1);
  BridgedMesh bridged;
  Points& vertices = bridged.mesh.vertices;
  const auto make_room = [&](int count) {
    bridged.core_vertex.resize(host.vert.size());
    bridged.host_vertex.resize(static_cast<std::size_t>(count));
    vertices.resize(count, 3);
  };
  each_existing(pool, host.vert, make_room, [&](std::size_t index, const CVertexO& vertex, int v) {
    bridged.core_vertex[index] = vertex.IsD() ? -1 : v;
    if (!vertex.IsD()) {
      bridged.host_vertex[static_cast<std::size_t>(v)] = static_cast<int>(index);
      vertices.row(v) = to_core(vertex.cP()).transpose();
    }
  });
  Faces& faces = bridged.mesh.faces;
  each_existing(
      pool, host.face, [&](int count) { faces.resize(count, 3); },
      [&](std::size_t, const CFaceO& face, int f) {
        for (int k = 0; k < 3 && !face.IsD(); ++k) {
          faces(f, k) = bridged.core_vertex[vcg::tri::Index(host, face.cV(k))];
        }
      });
  return bridged;
}

std::vector<int> selected_vertices(const CMeshO& host, const BridgedMesh& bridged) {
  std::vector<int> selected;
  for (std::size_t v = 0; v < bridged.host_vertex.size(); ++v) {
    if (host.vert[static_cast<std::size_t>(bridged.host_vertex[v])].IsS()) {
      selected.push_back(static_cast<int>(v));
    }
  }
  return selected;
}

std::vector<int> vertices_of_selected_faces(const CMeshO& host, const BridgedMesh& bridged) {
  std::vector<int> vertices;
  for (const CFaceO& face : host.face) {
    if (!face.IsD() && face.IsS()) {
      for (int k = 0; k < 3; ++k) {
        vertices.push_back(bridged.core_vertex[vcg::tri::Index(host, face.cV(k))]);
      }
    }
  }
  return sorted_set(std::move(vertices));
}

std::vector<int> selected_vertices_and_corners(const CMeshO& host, const std::vector<int>& core_vertex) {
  std::vector<char> chosen(host.vert.size(), 0);
  for (std::size_t v = 0; v < host.vert.size(); ++v) {
    chosen[v] = !host.vert[v].IsD() && host.vert[v].IsS() ? 1 : 0;
  }
  for (const CFaceO& face : host.face) {
    for (int k = 0; k < 3 && !face.IsD() && face.IsS(); ++k) {
      chosen[vcg::tri::Index(host, face.cV(k))] = 1;
    }
  }
  std::vector<int> vertices;
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    if (chosen[v] != 0) {
      vertices.push_back(core_vertex[v]);
    }
  }
  return vertices;
}

double finite_diagonal(const CMeshO& host) {
  const Box3m box = finite_box(host);
  return box.IsNull() ? 0 : (to_core(box.max) - to_core(box.min)).norm();
}

}  // namespace lapedit::host
