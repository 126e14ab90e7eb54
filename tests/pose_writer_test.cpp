// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/pose_writer.h"

#include <gtest/gtest.h>

#include <vcg/complex/algorithms/update/bounding.h>
#include <vcg/complex/algorithms/update/normal.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

#include "shapes.h"
#include "support.h"

namespace lapedit::host {
namespace {

void fill(CMeshO& host, const TriangleMesh& mesh) {
  using Allocator = vcg::tri::Allocator<CMeshO>;
  auto vertex = Allocator::AddVertices(host, static_cast<std::size_t>(mesh.vertices.rows()));
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v, ++vertex) {
    vertex->P() = to_host(mesh.vertices.row(v).transpose());
  }
  auto face = Allocator::AddFaces(host, static_cast<std::size_t>(mesh.faces.rows()));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f, ++face) {
    for (int k = 0; k < 3; ++k) {
      face->V(k) = &host.vert[static_cast<std::size_t>(mesh.faces(f, k))];
    }
  }
  vcg::tri::UpdateNormal<CMeshO>::PerFaceNormalized(host);
  vcg::tri::UpdateNormal<CMeshO>::PerVertexAngleWeighted(host);
  vcg::tri::UpdateBounding<CMeshO>::Box(host);
}

/// All that a write may change, as bits.
std::string bits(const CMeshO& host) {
  std::string result;
  const auto add = [&result](const Point3m& p) {
    result.append(reinterpret_cast<const char*>(p.V()), 3 * sizeof(Scalarm));
  };
  for (const CVertexO& vertex : host.vert) {
    add(vertex.cP());
    add(vertex.cN());
  }
  for (const CFaceO& face : host.face) {
    add(face.cN());
  }
  add(host.bbox.min);
  add(host.bbox.max);
  return result;
}

/// A host mesh with odd normals and a box that is too large, as files bring them, and some deleted elements.
class PoseWriterTest : public testing::Test {
 protected:
  PoseWriterTest() {
    fill(host_, shapes::letter_field(30, 15));
    for (std::size_t v = 0; v < host_.vert.size(); ++v) {
      host_.vert[v].N() *= static_cast<Scalarm>(1 + 0.1 * static_cast<double>(v % 7));
    }
    host_.face[5].N() = Point3m(1, 2, 3);
    host_.bbox.Add(Point3m(9, 9, 9));
    for (const std::size_t f : {std::size_t(40), std::size_t(41)}) {
      vcg::tri::Allocator<CMeshO>::DeleteFace(host_, host_.face[f]);
    }
    vcg::tri::Allocator<CMeshO>::DeleteVertex(host_, host_.vert.back());
    for (CFaceO& face : host_.face) {
      for (int k = 0; k < 3 && !face.IsD(); ++k) {
        if (face.V(k)->IsD()) {
          vcg::tri::Allocator<CMeshO>::DeleteFace(host_, face);
        }
      }
    }
    bridged_ = read_mesh(host_);
    adjacency_ = support::adjacency_of(bridged_.mesh);
    first_ = bits(host_);
  }

  EditResult somewhere(unsigned seed, int from, int count) const {
    std::mt19937 random(seed);
    EditResult result;
    for (int v = from; v < from + count; ++v) {
      result.vertices.push_back(v);
    }
    result.positions = support::rows(bridged_.mesh.vertices, result.vertices);
    for (Eigen::Index i = 0; i < result.positions.size(); ++i) {
      result.positions.data()[i] += 1e-3 * static_cast<double>(random() % 100);
    }
    return result;
  }

  EditResult home(const std::vector<int>& vertices) const {
    EditResult result;
    result.vertices = vertices;
    result.positions = support::rows(bridged_.mesh.vertices, vertices);
    return result;
  }

  CMeshO host_;
  BridgedMesh bridged_;
  Adjacency adjacency_;
  std::string first_;
};

TEST_F(PoseWriterTest, WritesWhatTheFilterWrites) {
  const EditResult pose = somewhere(1, 100, 80);
  PoseWriter writer(host_, bridged_, adjacency_);
  ASSERT_TRUE(writer.write(host_, pose.vertices, pose.positions, true));
  const std::string live = bits(host_);
  EXPECT_NE(live, first_);
  const EditResult back = home(pose.vertices);
  ASSERT_TRUE(writer.write(host_, back.vertices, back.positions, true));
  ASSERT_EQ(bits(host_), first_);
  write_positions(host_, bridged_, pose);
  EXPECT_EQ(bits(host_), live);
}

TEST_F(PoseWriterTest, WayBackEndsAtTheFirstBits) {
  PoseWriter writer(host_, bridged_, adjacency_);
  for (unsigned seed = 0; seed < 8; ++seed) {
    const EditResult pose = somewhere(seed, 20 * static_cast<int>(seed), 120);
    ASSERT_TRUE(writer.write(host_, pose.vertices, pose.positions, seed % 2 == 0));
  }
  for (unsigned seed = 0; seed < 8; ++seed) {
    const EditResult back = home(somewhere(seed, 20 * static_cast<int>(seed), 120).vertices);
    ASSERT_TRUE(writer.write(host_, back.vertices, back.positions, true));
    EXPECT_EQ(bits(host_) == first_, seed == 7);
  }
}

TEST_F(PoseWriterTest, OnlyThePositionsCountNotTheWay) {
  PoseWriter writer(host_, bridged_, adjacency_);
  const EditResult pose = somewhere(99, 50, 200);
  ASSERT_TRUE(writer.write(host_, pose.vertices, pose.positions, true));
  const std::string direct = bits(host_);
  for (unsigned seed = 0; seed < 5; ++seed) {
    const EditResult other = somewhere(seed, 50 + 10 * static_cast<int>(seed), 40);
    ASSERT_TRUE(writer.write(host_, other.vertices, other.positions, false));
  }
  ASSERT_TRUE(writer.write(host_, pose.vertices, pose.positions, true));
  EXPECT_EQ(bits(host_), direct);
}

TEST_F(PoseWriterTest, BrokenPosesGiveNoBrokenNormals) {
  PoseWriter writer(host_, bridged_, adjacency_);
  EditResult pose = somewhere(3, 100, 20);
  pose.positions.setZero();  // all in one point: faces without area
  ASSERT_TRUE(writer.write(host_, pose.vertices, pose.positions, true));
  for (const CVertexO& vertex : host_.vert) {
    EXPECT_TRUE(is_finite(vertex.cN()));
  }
  for (const CFaceO& face : host_.face) {
    EXPECT_TRUE(is_finite(face.cN()));
  }
}

TEST_F(PoseWriterTest, ChangesBySomebodyElseAreSeen) {
  PoseWriter writer(host_, bridged_, adjacency_);
  EXPECT_TRUE(writer.matches(host_));
  const EditResult pose = somewhere(1, 100, 80);
  ASSERT_TRUE(writer.write(host_, pose.vertices, pose.positions, false));
  EXPECT_TRUE(writer.matches(host_));

  host_.vert[150].P()[1] += 1;
  EXPECT_FALSE(writer.matches(host_));
  const std::string before = bits(host_);
  EXPECT_FALSE(writer.write(host_, pose.vertices, pose.positions, true));
  EXPECT_EQ(bits(host_), before);
  host_.vert[150].P() = to_host(pose.positions.row(50).transpose());
  EXPECT_TRUE(writer.matches(host_));

  std::swap(host_.face[0].V(0), host_.face[0].V(1));
  EXPECT_FALSE(writer.matches(host_));
  std::swap(host_.face[0].V(0), host_.face[0].V(1));
  vcg::tri::Allocator<CMeshO>::DeleteFace(host_, host_.face[0]);
  EXPECT_FALSE(writer.matches(host_));
  EXPECT_FALSE(writer.write(host_, pose.vertices, pose.positions, true));
}

/// For the time of a large region; its result does not depend on the threads that share it.
TEST(PoseWriter, LargeRegionsAreWrittenAsSmallOnes) {
  CMeshO at_once, in_parts;
  const TriangleMesh mesh = shapes::letter_field(254, 127);
  fill(at_once, mesh);
  fill(in_parts, mesh);
  const BridgedMesh bridged = read_mesh(at_once);
  const Adjacency adjacency = support::adjacency_of(bridged.mesh);
  PoseWriter writer(at_once, bridged, adjacency), other(in_parts, bridged, adjacency);
  Points places = bridged.mesh.vertices;
  places.col(2) += (3 * places.col(0)).array().sin().matrix();
  std::vector<int> all(static_cast<std::size_t>(places.rows()));
  std::iota(all.begin(), all.end(), 0);
  ASSERT_TRUE(writer.write(at_once, all, places, true));
  constexpr std::size_t kPart = 1000;
  for (std::size_t begin = 0; begin < all.size(); begin += kPart) {
    const std::vector<int> part(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                all.begin() + static_cast<std::ptrdiff_t>(std::min(begin + kPart, all.size())));
    ASSERT_TRUE(other.write(in_parts, part, support::rows(places, part), true));
  }
  EXPECT_EQ(bits(at_once), bits(in_parts));
}

}  // namespace
}  // namespace lapedit::host
