// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/positions.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "lapedit/edit/edit.h"
#include "lapedit/mesh/vertex_set.h"
#include "lapedit/mesh/vertex_tree.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::positions_test {
namespace {

using support::expect_contains;

TriangleMesh ball(int levels) {
  return shapes::icosphere(levels);
}

Vector3 position(const TriangleMesh& mesh, int vertex) {
  return mesh.vertices.row(vertex).transpose();
}

Edit located_on(const TriangleMesh& mesh, const Edit& edit, const SelectedVertices& selection = {}) {
  return located(mesh, support::adjacency_of(mesh), edit, selection);
}

/// An edit of one group.
Edit edit_of(HandleGroup group, double radius = 1) {
  Edit edit;
  edit.steps.resize(1);
  edit.steps[0].region.radius = radius;
  edit.steps[0].handles = {std::move(group)};
  return edit;
}

HandleGroup points_of(std::vector<Vector3> points, std::vector<Vector3> targets = {}) {
  HandleGroup group;
  group.query.points = std::move(points);
  group.targets = std::move(targets);
  return group;
}

std::string refusal(ErrorCause cause, const TriangleMesh& mesh, const Edit& edit,
                    const SelectedVertices& selection = {}) {
  return support::expect_refusal(cause, [&] { located_on(mesh, edit, selection); });
}

TEST(VertexQuery, ArePointsDiscsAndSelections) {
  const TriangleMesh mesh = ball(3);
  const Edit points = located_on(mesh, edit_of(points_of({1.01 * position(mesh, 40), position(mesh, 7)})));
  EXPECT_EQ(points.steps[0].handles[0].vertices, (std::vector<int>{40, 7}));
  EXPECT_TRUE(points.steps[0].handles[0].query.empty());

  Edit disc = edit_of({});
  disc.steps[0].handles[0].query.within = VertexQuery::Disc{0.99 * position(mesh, 12), 0.3};
  disc.steps[0].region.kind = RegionSpec::Kind::Vertices;
  disc.steps[0].region_query.within = VertexQuery::Disc{position(mesh, 12), 0.6};
  const Edit found = located_on(mesh, disc);
  const Adjacency around = support::adjacency_of(mesh);
  EXPECT_EQ(found.steps[0].handles[0].vertices, vertices_within(mesh, around, 12, 0.3));
  EXPECT_EQ(found.steps[0].region.vertices, vertices_within(mesh, around, 12, 0.6));

  Edit selected = edit_of({});
  selected.steps[0].handles[0].query.selected = true;
  selected.steps[0].region_query.selected = true;
  const SelectedVertices both = {{3}, {1, 2, 3}};
  EXPECT_EQ(located_on(mesh, selected, both).steps[0].handles[0].vertices, both.vertices);
  EXPECT_EQ(located_on(mesh, selected, both).steps[0].region.vertices, both.of_faces);
  EXPECT_EQ(located_on(mesh, selected, {{}, {1, 2}}).steps[0].handles[0].vertices, (std::vector<int>{1, 2}));
  EXPECT_EQ(located_on(mesh, selected, {{5}, {}}).steps[0].region.vertices, std::vector<int>{5});
  expect_contains(refusal(ErrorCause::NoHandle, mesh, selected), "No vertex and no face is selected");
}

/// A landmark is seldom at a vertex: the vertex moves as it does. At a vertex the target is met to the bit.
TEST(VertexQuery, VerticesMoveAsTheirPoints) {
  const TriangleMesh mesh = ball(3);
  const Vector3 off(0.004, -0.003, 0.002), way(0.1, 1.0 / 3, -0.2);
  const Edit edit = located_on(
      mesh, edit_of(points_of({position(mesh, 40) + off, position(mesh, 7)}, {position(mesh, 40) + off + way, way})));
  EXPECT_LT((edit.steps[0].handles[0].targets[0] - position(mesh, 40) - way).norm(), 1e-15);
  EXPECT_EQ(edit.steps[0].handles[0].targets[1], way);
}

TEST(VertexQuery, AreRefusedByName) {
  const TriangleMesh mesh = ball(3);
  HandleGroup group = points_of({position(mesh, 40), Vector3(0, 0, 5)}, {Vector3::Zero(), Vector3::Zero()});
  group.names = {"nose", "chin"};
  expect_contains(refusal(ErrorCause::BadParameter, mesh, edit_of(group)), "Landmark \"chin\" (0, 0, 5) is 4 away");
  group.query.points[1] = 1.001 * position(mesh, 40);
  expect_contains(refusal(ErrorCause::BadParameter, mesh, edit_of(group)),
                  "Landmark \"nose\" and Landmark \"chin\" are both nearest to vertex 40");
  group.query.points[1][0] = std::numeric_limits<double>::quiet_NaN();
  expect_contains(refusal(ErrorCause::NotFinite, mesh, edit_of(group)), "Landmark \"chin\" is not finite");
}

/// A ball whose vertices are none of another one's.
TriangleMesh turned_ball(int levels) {
  return support::moved(support::rigid(33, Vector3(1, 2, 3), Vector3::Zero()), ball(levels));
}

/// A set by position has no holes where the mesh is finer, and does not reach through the body.
TEST(VertexQuery, SetsAreAsDenseAsTheMeshAndStayOnTheirSide) {
  const TriangleMesh mesh = ball(3), fine = turned_ball(4);
  const Adjacency adjacency = support::adjacency_of(mesh);
  const int pole = VertexFinder(mesh).anywhere({0, 0, 1}, "Pole").vertex;
  HandleGroup group;
  group.vertices = vertices_within(mesh, adjacency, pole, 0.4);
  Edit edit = with_positions(mesh, adjacency, edit_of(group));
  const std::vector<int> set = located_on(fine, edit).steps[0].handles[0].vertices;
  edit.steps[0].handles[0].vertices.push_back(static_cast<int>(mesh.vertices.rows()) - 1);
  expect_contains(refusal(ErrorCause::MeshMismatch, fine, edit), "is not among mesh.positions");
  EXPECT_GT(set.size(), 3 * group.vertices.size());
  EXPECT_LT(set.size(), 6 * group.vertices.size());
  for (const int v : set) {
    EXPECT_LT((position(fine, v) - position(mesh, pole)).norm(), 0.55);
  }
}

}  // namespace
}  // namespace lapedit::positions_test
