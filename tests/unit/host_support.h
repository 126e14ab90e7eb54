// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>

#include "host_mesh.h"
#include "lapedit/mesh/triangle_mesh.h"

/// What the tests of host meshes share.
namespace lapedit::host {

inline void fill(CMeshO& host, const TriangleMesh& mesh) {
  using Allocator = vcg::tri::Allocator<CMeshO>;
  auto vertex = Allocator::AddVertices(host, static_cast<std::size_t>(mesh.vertices.rows()));
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v, ++vertex) {
    vertex->P() = Point3m(static_cast<Scalarm>(mesh.vertices(v, 0)), static_cast<Scalarm>(mesh.vertices(v, 1)),
                          static_cast<Scalarm>(mesh.vertices(v, 2)));
  }
  // Not AddFace(): it wants three different vertices.
  auto face = Allocator::AddFaces(host, static_cast<std::size_t>(mesh.faces.rows()));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f, ++face) {
    for (int k = 0; k < 3; ++k) face->V(k) = &host.vert[static_cast<std::size_t>(mesh.faces(f, k))];
  }
}

inline bool same_bits(const Point3m& a, const Point3m& b) {
  return std::memcmp(a.V(), b.V(), sizeof(Scalarm) * 3) == 0;
}

}  // namespace lapedit::host
