// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/hover.h"

#include <gtest/gtest.h>

#include "shapes.h"

namespace lapedit::hover_test {
namespace {

TEST(Hover, SearchInUseStaysWhenAnotherIsReady) {
  const auto mesh = std::make_shared<const TriangleMesh>(shapes::grid(5, 5));
  const auto other = std::make_shared<const TriangleMesh>(*mesh);
  const auto adjacency = std::make_shared<const Adjacency>(build_adjacency(25, mesh->faces));
  HoverBackground background([] {});
  EXPECT_EQ(background.of(mesh, adjacency), nullptr);
  background.wait();
  const HoverSearch* const used = background.of(mesh, adjacency);
  ASSERT_NE(used, nullptr);
  EXPECT_EQ(background.of(other, adjacency), nullptr);  // a step, which is undone before its search is ready
  background.wait();
  EXPECT_EQ(background.of(mesh, adjacency), used);
  EXPECT_EQ(background.latest(), used);
  EXPECT_NE(background.of(other, adjacency), nullptr);
}

TEST(Hover, OfSeveralQueriesTheLastIsAnswered) {
  const auto mesh = std::make_shared<const TriangleMesh>(shapes::grid(60, 60));
  const auto adjacency = std::make_shared<const Adjacency>(build_adjacency(3600, mesh->faces));
  HoverBackground background([] {});
  background.of(mesh, adjacency);
  background.wait();
  ASSERT_NE(background.of(mesh, adjacency), nullptr);
  HoverQuery query;
  for (int vertex = 1800; vertex < 1830; ++vertex) {
    query.vertex = vertex;
    query.radius = 12;
    query.disc = 3;
    background.outlines(query);
  }
  EXPECT_TRUE(background.finds_outlines());
  const HoverOutlines* found = nullptr;
  for (int answers = 0; answers < 3 && found == nullptr; ++answers) {
    background.wait();
    found = background.outlines(query);
  }
  ASSERT_NE(found, nullptr);
  EXPECT_FALSE(background.finds_outlines());
  const HoverOutlines expected = HoverSearch(*mesh, *adjacency).outlines(query);
  EXPECT_EQ(found->region, expected.region);
  EXPECT_EQ(found->disc, expected.disc);
  EXPECT_GT(found->region.rows(), 20);
}

}  // namespace
}  // namespace lapedit::hover_test
