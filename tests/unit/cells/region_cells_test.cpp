// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/region_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lapedit/cells/cell_pose.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::region_cells_test {
namespace {

/// A region and its cells.
struct Divided {
  Region region;
  Points rest;
  RegionCells cells;

  Divided(const TriangleMesh& mesh, const RegionSpec& spec, const std::vector<std::vector<int>>& handles,
          int target = 0)
      : region(support::region_of(mesh, spec, handles)), rest(support::rows(mesh.vertices, region.mesh_vertex)) {
    ThreadPool pool(1);
    cells = make_cells(region, rest, target > 0 ? target : CellPose::wanted_cells(region.size()), pool);
  }

  /// Whether all vertices of a cell are of one class.
  std::vector<char> all(VertexClass wanted) const {
    std::vector<char> result(cells.count(), 1);
    for (int i = 0; i < region.size(); ++i) {
      result[cells.of[i]] &= region.classes[i] == wanted ? 1 : 0;
    }
    return result;
  }
  /// The number of cells between those that are all handle and those that are all anchor.
  int cells_across() const {
    const std::vector<char> anchor = all(VertexClass::Anchor);
    std::vector<char> reached = all(VertexClass::Handle);
    for (int steps = 0; steps < cells.count(); ++steps) {
      std::vector<char> next = reached;
      for (int c = 0; c < cells.count(); ++c) {
        for (const int near : cells.neighbours[c]) {
          next[c] |= reached[near];
        }
        if (next[c] && anchor[c]) {
          return steps;
        }
      }
      reached = next;
    }
    return cells.count();
  }
};

TriangleMesh shaken(TriangleMesh mesh) {
  std::mt19937 generator(5);
  const double far = 0.1 * support::mean_edge(mesh);
  for (double& x : mesh.vertices.reshaped()) {
    x += far * (static_cast<double>(generator() % 2001) / 1000 - 1);
  }
  return mesh;
}

/// A tube of radius 1 and length 16 with a handle at one side of its middle and anchors at the other one.
Divided elbow(double joint, int target) {
  TriangleMesh mesh = shapes::cylinder(60, 400);
  mesh.vertices.col(0) *= 4;
  RegionSpec spec = support::given(support::vertices_where(mesh, [](const Vector3&) { return true; }));
  spec.anchors.vertices = support::vertices_where(mesh, [=](const Vector3& p) { return p[0] < 8 - joint / 2; });
  spec.anchors.weights.assign(spec.anchors.vertices.size(), 1);
  spec.anchors.depths.assign(spec.anchors.vertices.size(), 1);
  spec.anchors.reach = joint;
  return {mesh, spec, {support::vertices_where(mesh, [=](const Vector3& p) { return p[0] > 8 + joint / 2; })}, target};
}

/// tests/cli/edits_test.py numbers, moves and scales meshes.
TEST(RegionCells, DoNotDependOnTheOrderOfGroupsOfOneVertex) {
  const TriangleMesh mesh = shapes::grid(21, 21);
  const std::vector<int> one = {220}, other = {222};
  EXPECT_EQ(Divided(mesh, support::within(8), {one, other}).cells.of,
            Divided(mesh, support::within(8), {other, one}).cells.of);
}

TEST(RegionCells, ShortJointsBetweenRigidPartsGetMostOfThem) {
  for (const double joint : {1.0, 2.0, 4.0}) {
    for (const int target : {400, 1200}) {
      const Divided divided = elbow(joint, target);
      const std::vector<char> handle = divided.all(VertexClass::Handle), anchor = divided.all(VertexClass::Anchor);
      const auto rigid = std::count(handle.begin(), handle.end(), 1) + std::count(anchor.begin(), anchor.end(), 1);
      EXPECT_LT(divided.cells.count(), 1.2 * target) << joint;
      EXPECT_LT(rigid, 0.45 * divided.cells.count()) << joint << ", " << target;
      EXPECT_GT(rigid, 20) << joint;
      EXPECT_GE(divided.cells_across(), 6) << joint << ", " << target;
    }
  }
}

TEST(RegionCells, AreAsLongAsWideWhateverTheTrianglesAre) {
  for (const double stretch : {0.25, 1.0, 4.0, 12.0}) {
    const int around = 96;
    const double edge = 2 * std::acos(-1.0) / around, length = 12 * std::max(1.0, stretch / 2);
    TriangleMesh mesh = shapes::cylinder(around, static_cast<int>(length / (stretch * edge)));
    mesh.vertices.col(0) *= length / 4;
    const RegionSpec spec = support::given(support::vertices_where(mesh, [](const Vector3& p) { return p[0] > 1; }));
    const Divided divided(mesh, spec,
                          {support::vertices_where(mesh, [=](const Vector3& p) { return p[0] > length - 1; })}, 200);
    double along = 0, across = 0;
    for (int i = 0; i < divided.region.size(); ++i) {
      if (divided.rest(i, 0) > 2 && divided.rest(i, 0) < length - 2) {
        const auto way = divided.rest.row(i) - divided.cells.centres.row(divided.cells.of[i]);
        along += way[0] * way[0];
        across += way[1] * way[1] + way[2] * way[2];
      }
    }
    EXPECT_NEAR(std::log2(along / across), 0, 1.2) << stretch;
  }
}

/// Nothing but the blend: what is linear in the positions of the cells' centres comes out as it is.
TEST(RegionCells, BlendReproducesLinearFunctionsAlongTheSurface) {
  const TriangleMesh mesh = shapes::letter_field(160, 80);
  const Region region = support::region_of(mesh, support::component(), {{support::vertex_at(mesh, {2, 1, 0})}});
  ThreadPool pool(2);
  const RegionCells cells = make_cells(region, mesh.vertices, 800, pool);
  EXPECT_NEAR(cells.count(), 800, 80);
  const CellBlend blend(cells, mesh.vertices, pool);
  double sum = 0;
  for (int i = 0; i < region.size(); ++i) {
    double one = 0;
    Vector2 position = Vector2::Zero();
    for (int k = 0; k < CellBlend::kReach; ++k) {
      one += blend.weights(k, i);
      position += blend.weights(k, i) * cells.centres.row(blend.cells(k, i)).head<2>().transpose();
    }
    EXPECT_NEAR(one, 1, 1e-5);
    sum += (position - mesh.vertices.row(i).head<2>().transpose()).squaredNorm();
  }
  const double spacing = std::sqrt(8.0 / cells.count());  // of 4 x 2 units
  EXPECT_LT(std::sqrt(sum / region.size()), 0.15 * spacing);
}

/// Near the boundary some vertices are on one side of all cells in reach; they must not be extrapolated far from them.
TEST(RegionCells, BlendDoesNotExtrapolateFar) {
  const TriangleMesh mesh = shaken(shaken(shaken(shapes::grid(120, 120))));
  const int centre = support::vertex_at(mesh, {60, 60, 0});
  ThreadPool pool(2);
  for (int radius = 20; radius < 59; ++radius) {
    const Divided divided(mesh, support::within(radius), {{centre}});
    const CellBlend blend(divided.cells, divided.rest, pool);
    EXPECT_LT(blend.weights.abs().maxCoeff(), 1.5) << radius;
    EXPECT_LT((blend.weights.colwise().sum() - 1).abs().maxCoeff(), 1e-5F) << radius;
  }
}

TEST(RegionCells, EveryVertexIsInOneConnectedCell) {
  const TriangleMesh mesh = shapes::two_pieces(4);
  const Region region =
      support::region_of(mesh, support::component(), {{0, static_cast<int>(mesh.vertices.rows()) - 1}});
  ThreadPool pool(1);
  const RegionCells cells = make_cells(region, mesh.vertices, 40, pool);
  std::vector<double> sizes(cells.count(), 0);
  for (int i = 0; i < region.size(); ++i) {
    ASSERT_GE(cells.of[i], 0);
    ASSERT_LT(cells.of[i], cells.count());
    sizes[cells.of[i]] += 1;
  }
  EXPECT_EQ(sizes, cells.vertices);
  double area = 0;
  for (int c = 0; c < cells.count(); ++c) {
    EXPECT_GT(sizes[c], 0);
    area += cells.area[c];
    for (const int other : cells.neighbours[c]) {
      const auto back = cells.neighbours[other];
      EXPECT_TRUE(std::binary_search(back.begin(), back.end(), c));
    }
  }
  EXPECT_GT(area, 0);
  for (const auto& [a, b, c] : cells.triangles) {
    EXPECT_TRUE(a < b && b < c) << "three cells meet";
  }
}

}  // namespace
}  // namespace lapedit::region_cells_test
