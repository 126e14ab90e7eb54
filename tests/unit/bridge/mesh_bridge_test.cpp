// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/mesh_bridge.h"

#include <gtest/gtest.h>

#include <vcg/complex/algorithms/update/bounding.h>
#include <vcg/complex/algorithms/update/normal.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "host_support.h"
#include "lapedit/base/error.h"
#include "lapedit_host/pose_writer.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::host::mesh_bridge_test {
namespace {

using Allocator = vcg::tri::Allocator<CMeshO>;

/// Moves the given vertices of the bridged mesh by an offset.
void shift(CMeshO& host, const BridgedMesh& bridged, const std::vector<int>& vertices, const Vector3& offset) {
  EditResult result;
  result.vertices = vertices;
  result.positions = support::rows(bridged.mesh.vertices, vertices).rowwise() + offset.transpose();
  write_positions(host, bridged, support::adjacency_of(bridged.mesh), result);
}

TEST(MeshBridge, RefusesFacesThatNameNoVertex) {
  for (const int number : {-1, 20, 400}) {
    CMeshO host;
    fill(host, shapes::grid(4, 5));
    // As readers do with a number from a file.
    const auto address = reinterpret_cast<std::intptr_t>(host.vert.data()) + number * std::intptr_t(sizeof(CVertexO));
    host.face[7].V(1) = reinterpret_cast<CVertexO*>(address);  // NOLINT(performance-no-int-to-ptr)
    try {
      read_mesh(host);
      ADD_FAILURE() << number;
    } catch (const EditError& error) {
      EXPECT_EQ(error.cause(), ErrorCause::BadIndex);
      EXPECT_EQ(error.what(), "Face 7 names vertex " + std::to_string(number) +
                                  ", but there are 20 vertices, counted from 0: correct the file that the mesh was "
                                  "read from.");
    }
    Allocator::DeleteFace(host, host.face[7]);
    EXPECT_NO_THROW(read_mesh(host));
  }
}

TEST(MeshBridge, ReadsALargeMeshInItsOrder) {
  const TriangleMesh mesh = shapes::icosphere(6);  // enough for several threads
  CMeshO host;
  fill(host, mesh);
  for (std::size_t f = 0; f < host.face.size(); ++f) {
    if (f % 7 == 3 || f > 80000) Allocator::DeleteFace(host, host.face[f]);  // not evenly
  }
  std::vector<char> used(host.vert.size(), 0);
  for (const CFaceO& face : host.face) {
    for (int k = 0; k < 3 && !face.IsD(); ++k) used[vcg::tri::Index(host, face.cV(k))] = 1;
  }
  for (std::size_t v = 0; v < host.vert.size(); ++v) {
    if (!used[v]) Allocator::DeleteVertex(host, host.vert[v]);
  }
  ASSERT_LT(host.vn, mesh.vertices.rows());
  const BridgedMesh bridged = read_mesh(host);
  ASSERT_EQ(bridged.mesh.vertices.rows(), host.vn);
  ASSERT_EQ(bridged.mesh.faces.rows(), host.fn);
  ASSERT_EQ(bridged.core_vertex.size(), host.vert.size());
  validate(bridged.mesh);
  int vertices = 0, faces = 0;
  for (std::size_t v = 0; v < host.vert.size(); ++v) {
    EXPECT_EQ(bridged.core_vertex[v], used[v] ? vertices : -1);
    if (used[v]) {
      EXPECT_EQ(bridged.host_vertex[static_cast<std::size_t>(vertices)], static_cast<int>(v));
      EXPECT_EQ(bridged.mesh.vertices.row(vertices++).transpose(), to_core(host.vert[v].cP()));
    }
  }
  for (const CFaceO& face : host.face) {
    for (int k = 0; k < 3 && !face.IsD(); ++k) {
      EXPECT_EQ(bridged.mesh.faces(faces, k), bridged.core_vertex[vcg::tri::Index(host, face.cV(k))]);
    }
    faces += face.IsD() ? 0 : 1;
  }
}

TEST(MeshBridge, FaceOnADeletedVertexIsRefusedByTheCore) {
  CMeshO host;
  fill(host, shapes::grid(3, 3));
  host.vert[4].SetD();
  EXPECT_ANY_THROW(validate(read_mesh(host).mesh));
}

TEST(MeshBridge, NormalsAreTheHostsOwnAroundMovedVerticesAndUntouchedElsewhere) {
  CMeshO host, expected;
  fill(host, shapes::icosphere(2));
  const Point3m mark(3, 4, 5);
  for (CVertexO& vertex : host.vert) vertex.N() = mark;
  for (CFaceO& face : host.face) face.N() = mark;
  const int moved = 20;
  shift(host, read_mesh(host), {moved}, {0.1, 0.2, 0});
  fill(expected, read_mesh(host).mesh);
  vcg::tri::UpdateNormal<CMeshO>::PerFaceNormalized(expected);
  vcg::tri::UpdateNormal<CMeshO>::PerVertexAngleWeighted(expected);
  vcg::tri::UpdateBounding<CMeshO>::Box(expected);
  std::vector<char> near(host.vert.size(), 0);
  for (std::size_t f = 0; f < host.face.size(); ++f) {
    std::size_t corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = vcg::tri::Index(host, host.face[f].cV(k));
    const bool touched = std::count(corners, corners + 3, moved) > 0;
    EXPECT_LT((host.face[f].cN() - (touched ? expected.face[f].cN() : mark)).Norm(), 1e-5) << f;
    for (const std::size_t v : corners) near[v] |= static_cast<char>(touched);
  }
  for (std::size_t v = 0; v < host.vert.size(); ++v) {
    EXPECT_LT((host.vert[v].cN() - (near[v] ? expected.vert[v].cN() : mark)).Norm(), 2e-5) << v;
  }
  EXPECT_EQ(host.bbox.min, expected.bbox.min);
  EXPECT_EQ(host.bbox.max, expected.bbox.max);
}

TEST(MeshBridge, DiagonalOfAMeshWithoutFiniteVerticesIsZero) {
  CMeshO host;
  EXPECT_EQ(finite_diagonal(host), 0);
  fill(host, shapes::grid(2, 2));
  EXPECT_NEAR(finite_diagonal(host), std::sqrt(2.0), 1e-12);
  for (CVertexO& vertex : host.vert) vertex.P()[0] = std::numeric_limits<Scalarm>::quiet_NaN();
  EXPECT_EQ(finite_diagonal(host), 0);
}

TEST(MeshBridge, SelectionsSkipWhatIsDeleted) {
  CMeshO host;
  fill(host, shapes::grid(4, 4));
  for (const int v : {0, 5, 6, 15}) host.vert[v].SetS();
  for (const int f : {0, 2, 3}) host.face[f].SetS();
  Allocator::DeleteFace(host, host.face[0]);
  Allocator::DeleteVertex(host, host.vert[0]);
  const BridgedMesh bridged = read_mesh(host);
  EXPECT_EQ(selected_vertices(host, bridged.core_vertex), (std::vector<int>{4, 5, 14}));
  // Faces 2 and 3: host vertices 1, 5, 2 and 2, 5, 6.
  EXPECT_EQ(vertices_of_selected_faces(host, bridged.core_vertex), (std::vector<int>{0, 1, 4, 5}));
}

/// tests/cli/attributes_test.py compares all others, as MeshLab saves them.
TEST(MeshBridge, LeavesOwnAttributesAndTheTransformAlone) {
  CMeshO host;
  fill(host, shapes::icosphere(1));
  host.vert.EnableRadius();
  auto own_float = Allocator::AddPerVertexAttribute<float>(host, "own");
  host.Tr.SetRotateDeg(40, Point3m(1, 2, 3));
  const Matrix44m transform = host.Tr;
  const auto number = [](std::size_t v) { return static_cast<float>(v) + 0.25f; };
  for (std::size_t v = 0; v < host.vert.size(); ++v) host.vert[v].R() = own_float[v] = number(v);
  const BridgedMesh bridged = read_mesh(host);
  shift(host, bridged, {0, 1, 2, 3, 20, 41}, {1, 2, 3});
  ASSERT_EQ(host.vert[41].cP()[0], static_cast<Scalarm>(bridged.mesh.vertices(41, 0) + 1));
  for (std::size_t v = 0; v < host.vert.size(); ++v) {
    EXPECT_EQ(host.vert[v].cR(), number(v));
    EXPECT_EQ(own_float[v], number(v));
  }
  EXPECT_TRUE(host.Tr == transform);
  Allocator::DeletePerVertexAttribute(host, own_float);  // the mesh does not free it itself
}

}  // namespace
}  // namespace lapedit::host::mesh_bridge_test
