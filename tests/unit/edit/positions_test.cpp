// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/positions.h"

#include <gtest/gtest.h>

#include <cmath>
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

const TriangleMesh kBall = shapes::icosphere(3);

Vector3 position(int vertex) {
  return position_of(kBall.vertices, vertex);
}

Edit located_on_ball(const Edit& edit, const SelectedVertices& selection = {}) {
  return located(kBall, support::adjacency_of(kBall), edit, selection);
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

std::string refusal(ErrorCause cause, const Edit& edit, const SelectedVertices& selection = {}) {
  return support::expect_refusal(cause, [&] { located_on_ball(edit, selection); });
}

TEST(VertexQuery, ArePointsDiscsAndSelections) {
  const Edit points = located_on_ball(edit_of(points_of({1.01 * position(40), position(7)})));
  EXPECT_EQ(points.steps[0].handles[0].vertices, (std::vector<int>{40, 7}));
  EXPECT_TRUE(points.steps[0].handles[0].query.empty());

  Edit disc = edit_of({});
  disc.steps[0].handles[0].query.within = VertexQuery::Disc{0.99 * position(12), 0.3};
  disc.steps[0].region.kind = RegionSpec::Kind::Vertices;
  disc.steps[0].region_query.within = VertexQuery::Disc{position(12), 0.6};
  const Edit found = located_on_ball(disc);
  const Adjacency around = support::adjacency_of(kBall);
  EXPECT_EQ(found.steps[0].handles[0].vertices, vertices_within(kBall, around, 12, 0.3));
  EXPECT_EQ(found.steps[0].region.vertices, vertices_within(kBall, around, 12, 0.6));

  Edit selected = edit_of({});
  selected.steps[0].handles[0].query.selected = true;
  selected.steps[0].region_query.selected = true;
  const SelectedVertices both = {{3}, {1, 2, 3}};
  EXPECT_EQ(located_on_ball(selected, both).steps[0].handles[0].vertices, both.vertices);
  EXPECT_EQ(located_on_ball(selected, both).steps[0].region.vertices, both.of_faces);
  EXPECT_EQ(located_on_ball(selected, {{}, {1, 2}}).steps[0].handles[0].vertices, (std::vector<int>{1, 2}));
  EXPECT_EQ(located_on_ball(selected, {{5}, {}}).steps[0].region.vertices, std::vector<int>{5});
  expect_contains(refusal(ErrorCause::NoHandle, selected), "No vertex and no face is selected");
}

/// A landmark is seldom at a vertex: the vertex moves as it does. At a vertex the target is met to the bit.
TEST(VertexQuery, VerticesMoveAsTheirPoints) {
  const Vector3 off(0.004, -0.003, 0.002), way(0.1, 1.0 / 3, -0.2);
  const Edit edit =
      located_on_ball(edit_of(points_of({position(40) + off, position(7)}, {position(40) + off + way, way})));
  EXPECT_LT((edit.steps[0].handles[0].targets[0] - position(40) - way).norm(), 1e-15);
  EXPECT_EQ(edit.steps[0].handles[0].targets[1], way);
}

TEST(VertexQuery, PointsThatAreNotFiniteAndVerticesWithoutPositionAreRefused) {
  HandleGroup group = points_of({position(40), Vector3(0, std::nan(""), 0)});
  group.names = {"nose", "chin"};
  expect_contains(refusal(ErrorCause::NotFinite, edit_of(group)), "Landmark \"chin\" is not finite");
  group = {};
  group.vertices = {40};
  Edit edit = with_positions(kBall, support::adjacency_of(kBall), edit_of(group));
  edit.steps[0].handles[0].vertices.push_back(641);
  expect_contains(refusal(ErrorCause::MeshMismatch, edit), "is not among mesh.positions");
}

}  // namespace
}  // namespace lapedit::positions_test
