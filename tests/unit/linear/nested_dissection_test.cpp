// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/nested_dissection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "linear/operators.h"

namespace lapedit::nested_dissection_test {
namespace {

using support::Graph;
using support::Surface;
using support::surface;

/// A surface with diagonals in random directions and numbers in any order.
Graph irregular(Surface kind, int around, int along) {
  return renumbered(surface(kind, around, along, true), support::shuffled(around * along, 4));
}

void expect_permutation(std::vector<int> order, int n) {
  ASSERT_EQ(static_cast<int>(order.size()), n);
  std::sort(order.begin(), order.end());
  for (int k = 0; k < n; ++k) ASSERT_EQ(order[k], k);
}

/// A tube whose ends are closed by a vertex each.
Graph drum(int around, int along) {
  Graph graph = together(surface(Surface::Tube, around, along), support::lone_vertices(2));
  for (int i = 0; i < around; ++i) {
    graph.edges.emplace_back(around * along, along * i);
    graph.edges.emplace_back(around * along + 1, along * i + along - 1);
  }
  return graph;
}

Graph all_in_one_point() {
  Graph graph = surface(Surface::Torus, 80, 128);
  graph.points.setConstant(7);
  return graph;
}

Graph points_in_no_order() {
  Graph graph = surface(Surface::Plane, 80, 80);
  graph.points = support::rows(graph.points, support::shuffled(6400, 1)) * 1e200;
  return graph;
}

Graph many_pieces() {
  Graph graph = support::lone_vertices(3000);
  for (int v = 0; v < 2400; ++v) {
    graph.edges.emplace_back(v, v % 3 < 2 ? v + 1 : v - 2);
  }
  return together(graph, surface(Surface::Torus, 32, 80));
}

Graph random_graph() {
  Graph graph = support::lone_vertices(1500);
  std::mt19937 random(1);
  for (double& x : graph.points.reshaped()) {
    x = random() % 1000;
  }
  for (int k = 0; k < 9000; ++k) {
    const int a = static_cast<int>(random() % 1500), b = static_cast<int>(random() % 1500);
    graph.edges.emplace_back(a, b);
  }
  return graph;
}

TEST(NestedDissection, NamesEachVertexOnceWhateverTheThreads) {
  for (const Graph& graph :
       {irregular(Surface::Plane, 120, 60), surface(Surface::Torus, 80, 128), surface(Surface::Tube, 40, 200),
        drum(600, 10), surface(Surface::Plane, 3, 3000), surface(Surface::Plane, 2, 2),
        together(surface(Surface::Plane, 60, 80), support::lone_vertices(5)),
        together(surface(Surface::Torus, 32, 80), surface(Surface::Torus, 32, 80)), support::wheel(1500),
        support::wheel(700), all_in_one_point(), points_in_no_order(), many_pieces(), random_graph(),
        support::lone_vertices(3000)}) {
    const CompressedRows neighbours = graph.neighbours();
    const std::vector<int> order = nested_dissection(neighbours, graph.points);
    expect_permutation(order, graph.size());
    for (const int threads : {2, 3, 0}) {
      EXPECT_EQ(nested_dissection(neighbours, graph.points, threads), order) << threads << " threads";
    }
  }
}

TEST(NestedDissection, TakesNoneAndOne) {
  for (const int n : {0, 1, 2}) {
    const Graph graph = support::lone_vertices(n);
    expect_permutation(nested_dissection(graph.neighbours(), graph.points), n);
  }
}

TEST(NestedDissection, DoesNotDependOnTheUnit) {
  const Graph graph = irregular(Surface::Plane, 120, 60);
  const CompressedRows neighbours = graph.neighbours();
  const std::vector<int> order = nested_dissection(neighbours, graph.points);
  EXPECT_EQ(nested_dissection(neighbours, graph.points * 0x1p40), order);
  EXPECT_EQ(nested_dissection(neighbours, graph.points * 0x1p-900), order);
}

double relative_fill(const Graph& graph) {
  return support::relative_fill(graph, nested_dissection(graph.neighbours(), graph.points));
}

TEST(NestedDissection, FillsAboutAsMuchAsMinimumDegreeAndLessOnLargeGraphs) {
  EXPECT_LT(relative_fill(irregular(Surface::Plane, 160, 80)), 1.1);
  EXPECT_LT(relative_fill(surface(Surface::Tube, 80, 150)), 1.1);
  EXPECT_LT(relative_fill(surface(Surface::Torus, 80, 128)), 0.95);
  EXPECT_LT(relative_fill(irregular(Surface::Plane, 284, 142)), 1);
  EXPECT_LT(relative_fill(irregular(Surface::Torus, 160, 256)), 0.9);
  EXPECT_LT(relative_fill(drum(600, 20)), 1.2) << "each cap is a clique of 600";
  EXPECT_LT(relative_fill(many_pieces()), 1.02);
  EXPECT_LT(relative_fill(all_in_one_point()), 1.1);
}

}  // namespace
}  // namespace lapedit::nested_dissection_test
