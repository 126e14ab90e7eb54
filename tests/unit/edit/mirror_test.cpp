// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/mirror.h"

#include <gtest/gtest.h>

#include "allocation_watch.h"
#include "lapedit/mesh/vertex_set.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::mirror_test {
namespace {

const Vector3 kLeft(-0.6, 0, 0.8), kRight(0.6, 0, 0.8);

std::vector<int> disc(const TriangleMesh& mesh, const Vector3& middle, double radius) {
  return vertices_within(mesh, support::adjacency_of(mesh), support::vertex_at(mesh, middle), radius);
}

HandleTransform moved_turned_and_grown() {
  HandleTransform transform;
  transform.translation = Vector3(0.1, 0.05, 0.25);
  transform.axis = Vector3(1, 2, 1);
  transform.degrees = 25;
  transform.scale = 1.1;
  return transform;
}

/// tests/cli/edits_test.py tests that results are symmetric.
TEST(Mirror, AllocatesNothingInAFrame) {
  const TriangleMesh mesh = shapes::icosphere(3);
  const MirroredHandles handles(mesh, {disc(mesh, kRight, 0.15)}, {{0.05, 0, 0}, {2, 0, 0}});
  ASSERT_EQ(handles.groups().size(), 2U);
  const std::vector<HandleTransform> transforms{moved_turned_and_grown()};
  std::vector<HandleMotion> maps;
  handles.maps(transforms, maps);
  const long before = allocations;
  handles.maps(transforms, maps);
  EXPECT_EQ(allocations, before);
}

/// A group that its own image meets moves by what is the same on both sides.
TEST(Mirror, GroupAcrossThePlaneKeepsTheSymmetricMotion) {
  const TriangleMesh mesh = shapes::icosphere(4);
  const MirrorPlane plane;
  const std::vector<int> across = disc(mesh, {0.05, 0, 1}, 0.2);
  const MirroredHandles handles(mesh, {across}, plane);
  ASSERT_EQ(handles.groups().size(), 1U);
  EXPECT_GT(handles.groups()[0].size(), across.size());
  const Affine mirror = reflection(plane);
  HandleTransform transform = moved_turned_and_grown();
  transform.axis = Vector3(1, 0, 0);
  std::vector<HandleMotion> maps;
  handles.maps({transform}, maps);
  EXPECT_LT((maps[0].map.matrix() - (mirror * maps[0].map * mirror).matrix()).norm(), 1e-12);
  EXPECT_NEAR(maps[0].map.linear().determinant(), std::pow(1.1, 3), 1e-12)
      << "the rotation is about the normal: all of it stays";
  EXPECT_NEAR(handles.transform(0, {transform}).degrees, 25, 1e-12);
  EXPECT_EQ(handles.transform(0, {transform}).translation, Vector3(0, 0.05, 0.25));
  transform.axis = Vector3(0, 1, 0);
  EXPECT_EQ(handles.transform(0, {transform}).degrees, 0) << "an axis in the plane";
  transform.matrix = (support::rigid(40, {1, 1, 0}, {0.1, 0.2, 0.3}) * Eigen::Scaling(1.2, 0.8, 1.0)).matrix();
  handles.maps({transform}, maps);
  EXPECT_LT((maps[0].map.matrix() - (mirror * maps[0].map * mirror).matrix()).norm(), 1e-12);
}

TEST(Mirror, GivenGroupsKeepTheirVertices) {
  const TriangleMesh mesh = shapes::icosphere(4);
  const std::vector<int> right = disc(mesh, kRight, 0.2), left = disc(mesh, kLeft, 0.1);
  const MirroredHandles handles(mesh, {right, left}, MirrorPlane());
  ASSERT_EQ(handles.groups().size(), 3U) << "the right one's image around the left one; the left one's is all taken";
  for (const int v : handles.groups()[2]) {
    EXPECT_FALSE(std::binary_search(left.begin(), left.end(), v));
  }
  EXPECT_EQ(handles.groups()[2].size() + left.size(), right.size());
}

/// On a surface whose other side is coarser, a vertex is the image of several.
TEST(Mirror, ImageFollowsTheNearestOfSeveralVertices) {
  TriangleMesh mesh = shapes::together(shapes::icosphere(3), shapes::icosphere(5), {3, 0, 0});
  mesh.vertices = mesh.vertices.colwise().reverse().eval();  // others come before the exact partners
  mesh.faces = (static_cast<int>(mesh.vertices.rows()) - 1 - mesh.faces.array()).matrix().eval();
  const std::vector<int> group = disc(mesh, {3, 0, 1}, 0.4);
  std::vector<Vector3> targets;
  targets.reserve(group.size());
  for (const int v : group) {
    targets.push_back(position_of(mesh.vertices, v) * 2);
  }
  const MirroredHandles handles(mesh, {group}, {{1.5, 0, 0}, {1, 0, 0}});
  ASSERT_EQ(handles.groups().size(), 2U);
  std::vector<Vector3> mirrored;
  handles.targets(1, {targets}, mirrored);
  int inside = 0;  // with their exact partners in the group
  for (std::size_t k = 0; k < mirrored.size(); ++k) {
    const Vector3 rest = position_of(mesh.vertices, handles.groups()[1][k]);
    if ((rest - Vector3::UnitZ()).norm() < 0.3) {
      EXPECT_LT((mirrored[k] - Vector3(2 * rest.x() - 3, 2 * rest.y(), 2 * rest.z())).norm(), 1e-9);
      ++inside;
    }
  }
  EXPECT_GT(inside, 5);
}

/// On a surface whose other side is finer, an image has no holes.
TEST(Mirror, ImageIsAsDenseAsTheSurfaceThere) {
  const TriangleMesh mesh = shapes::together(shapes::icosphere(3), shapes::icosphere(5), {3, 0, 0});
  const MirrorPlane plane{{1.5, 0, 0}, {1, 0, 0}};
  const std::vector<int> group = disc(mesh, {0, 0, 1}, 0.4);
  const MirroredHandles handles(mesh, {group}, plane);
  ASSERT_EQ(handles.groups().size(), 2U);
  EXPECT_GT(handles.groups()[1].size(), 8 * group.size());
  EXPECT_EQ(MirroredHandles(mesh, {{group[0]}}, plane).groups()[1].size(), 1U);
}

TEST(Mirror, OrderOfGroupsDoesNotMatter) {
  const TriangleMesh mesh = shapes::together(shapes::icosphere(3), shapes::icosphere(5), {3, 0, 0});
  const MirrorPlane plane{{1.5, 0, 0}, {1, 0, 0}};
  const std::vector<int> disc_there = disc(mesh, {3, 0, 1}, 0.4);
  std::vector<int> odd, even;  // with the same images
  for (const int v : disc_there) {
    (v % 2 == 0 ? even : odd).push_back(v);
  }
  const auto a = MirroredHandles(mesh, {odd, even}, plane).groups(),
             b = MirroredHandles(mesh, {even, odd}, plane).groups();
  ASSERT_EQ(a.size(), 4U);
  EXPECT_EQ(a, std::vector({b[1], b[0], b[3], b[2]}));
}

TEST(Mirror, WorkGrowsWithTheVerticesHoweverManyGroupsThereAre) {
  const TriangleMesh mesh = shapes::grid(60, 60);
  const MirrorPlane plane{{29.5, 0, 0}, {1, 0, 0}};
  const auto calls = [&](int count) {
    std::vector<std::vector<int>> groups;
    for (int g = 0; g < count; ++g) {
      groups.push_back({12 * g, 3599 - 12 * g});
    }
    int calls = 0;
    const Progress progress = [&calls](double, const char*) { return ++calls > 0; };
    const ProgressScope scope(progress);
    const MirroredHandles handles(mesh, groups, plane);
    return calls;
  };
  EXPECT_LE(calls(140), 1 + calls(3));
}

TEST(Mirror, KeptAnchorsAreMirroredWithTheirWeights) {
  const TriangleMesh mesh = shapes::icosphere(3);
  RegionSpec spec = support::given(disc(mesh, kRight, 0.4));
  spec.anchors.vertices = {spec.vertices[0], spec.vertices[3]};
  spec.anchors.weights = {0.25, 0.75};
  spec.anchors.depths = {0.5, 1};
  spec.anchors.reach = 0.4;
  const RegionSpec both = mirrored(mesh, spec, MirrorPlane());
  ASSERT_EQ(both.anchors.vertices.size(), 4U);
  EXPECT_EQ(both.anchors.reach, 0.4);
  for (std::size_t k = 2; k < 4; ++k) {
    const Vector3 image = Vector3(-1, 1, 1).cwiseProduct(mesh.vertices.row(both.anchors.vertices[k]).transpose());
    const int original = support::vertex_at(mesh, image);
    const auto at = std::find(spec.anchors.vertices.begin(), spec.anchors.vertices.end(), original);
    ASSERT_NE(at, spec.anchors.vertices.end());
    EXPECT_EQ(both.anchors.weights[k], spec.anchors.weights[at - spec.anchors.vertices.begin()]);
    EXPECT_EQ(both.anchors.depths[k], spec.anchors.depths[at - spec.anchors.vertices.begin()]);
  }
}

}  // namespace
}  // namespace lapedit::mirror_test
