// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/cells/cell_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "allocation_watch.h"
#include "lapedit/cells/small_cholesky.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::cell_pose_test {
namespace {

using Maps = std::vector<HandleMotion>;
using support::rigid;
using support::shift;

const double kDegree = std::acos(-1.0) / 180;

EditSettings settled(double membrane = 1200) {
  EditSettings settings;
  settings.membrane = membrane;
  return settings;
}

/// The vertices from one x to another.
std::vector<int> where(const TriangleMesh& mesh, double from, double to) {
  return support::vertices_where(mesh, [=](const Vector3& p) { return p[0] >= from && p[0] <= to; });
}

/// A region whose cells are turned without the rest of an editor.
struct Turned {
  TriangleMesh mesh;
  Region region;
  EditSettings settings;
  ThreadPool pool;
  Points rest;
  CellModel model;
  EditConstraints constraints;
  Points displacement;  // of the last spread()

  Turned(TriangleMesh of, const RegionSpec& spec, const std::vector<std::vector<int>>& handles, EditSettings with,
         int threads = 1)
      : mesh(std::move(of)),
        region(support::region_of(mesh, spec, handles)),
        settings(with),
        pool(threads),
        rest(support::rows(mesh.vertices, region.mesh_vertex)),
        model(support::rest_pose(mesh, region), settings, ThreadPool(threads)),
        constraints(*model.rest()) {}

  const CellPose& cells() const { return model.pose(); }
  const CellPose& solve(const Maps& maps, bool frame = false) {
    constraints.set(maps);
    model.solve(constraints.paths(), frame);
    return cells();
  }
  std::vector<Matrix3> spread() {
    std::vector<Matrix3> rotations;
    model.spread(constraints, rotations, displacement, pool);
    return rotations;
  }
};

/// A tube along x from 0 to 12, held at its root, whose tip is the handle.
std::unique_ptr<Turned> limb(const EditSettings& settings = settled(), int threads = 1) {
  TriangleMesh mesh = shapes::cylinder(24, 90);
  mesh.vertices.col(0) *= 3;
  const std::vector<std::vector<int>> tip = {where(mesh, 10.5, 12)};
  return std::make_unique<Turned>(mesh, support::given(where(mesh, 1, 12)), tip, settings, threads);
}

/// As a finger bends: the tip goes around on an arc of the limb's length.
Affine bent(double degrees) {
  const double angle = degrees * kDegree, from = 1, length = 9.5;
  const double radius = length / angle;
  const Vector3 end(from + radius * std::sin(angle), 0, radius * (1 - std::cos(angle)));
  return rigid(-degrees, Vector3::UnitY(), end - Vector3(from + length, 0, 0), Vector3(from + length, 0, 0));
}

double angle_of(const Matrix3& rotation) {
  return support::largest_angle({rotation}, {Matrix3::Identity()}) / kDegree;
}

double farthest(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

TEST(CellPose, BentLimbTurnsFromNothingAtTheBoundaryToTheGroupsTurnAtTheHandle) {
  const auto t = limb();
  for (const double degrees : {20.0, 90.0, 179.0}) {
    const Affine map = bent(degrees);
    t->solve({map});
    const std::vector<Matrix3> rotations = t->spread();
    std::vector<double> sums(12, 0), counts(12, 0);
    for (int i = 0; i < t->region.size(); ++i) {
      ASSERT_LT(support::rotation_defect(rotations[i]), 1e-12);
      ASSERT_LT(angle_of(rotations[i]), degrees + 6) << degrees;
      const auto slice = std::min(11, static_cast<int>(t->rest(i, 0)));
      sums[slice] += angle_of(rotations[i]);
      ++counts[slice];
      if (t->region.anchor_depth[i] == 1) {
        EXPECT_LT(angle_of(rotations[i]), 1e-6) << "held back at the end of the band";
      }
      if (t->rest(i, 0) > 11) {
        EXPECT_LT(support::largest_angle({rotations[i]}, {map.linear()}) / kDegree, 0.06 * degrees + 1) << degrees;
      }
    }
    for (int slice = 2; slice < 11; ++slice) {
      EXPECT_GT(sums[slice] / counts[slice] - sums[slice - 1] / counts[slice - 1], -0.02 * degrees) << degrees << slice;
    }
    EXPECT_NEAR(sums[6] / counts[6] / degrees, 0.57, 0.15) << "about half of it halfway";
  }
}

/// Fails if the passes that are made are too few: an edit that has settled hardly changes in a pass.
TEST(CellPose, ComesNearToWhatSettles) {
  const auto t = limb();
  for (const double degrees : {15.0, 90.0, 179.0}) {
    const Maps maps = {bent(degrees)};
    t->solve(maps);
    EXPECT_LT(t->cells().left(), 3e-3) << degrees;
    EXPECT_GT(t->cells().passes(), 12) << degrees;
  }
}

/// The global step by a dense solve, the local one by singular values: the settled state is a fixed point of both.
TEST(LocalGlobal, SettledStateSatisfiesItsEquations) {
  TriangleMesh mesh = shapes::cylinder(18, 50);
  mesh.vertices.col(0) *= 3;
  const Region region = support::region_of(mesh, support::given(where(mesh, 1, 12)), {where(mesh, 11, 12)});
  const Points rest = support::rows(mesh.vertices, region.mesh_vertex);
  ThreadPool pool(1);
  for (const double membrane : {0.0, 1200.0}) {
    const EditSettings settings = settled(membrane);
    const RegionCells cells = make_cells(region, rest, 100, pool);
    const CellBlend blend(cells, rest, pool);
    const CellSurface surface(cells);
    CoarseSystem system(region, rest, cells, blend, settings);
    const std::vector<double> hold(cells.count(), 0);
    const std::vector<double> inertia(cells.count(), 0.5);
    LocalGlobal local_global(cells, surface, hold, inertia, system);
    Points constraints = Points::Zero(cells.count(), 3), displacement;
    std::vector<Matrix3> rotations(cells.count(), Matrix3::Identity());
    const Affine map = bent(60);
    for (const CoarseSystem::Held& held : system.held()) {
      for (const auto& [cell, weight] : held.row) {
        constraints.row(cell) += held.weight * weight * (map * held.mean - held.mean).transpose();
      }
    }
    local_global.start(cells.centres, std::vector<Matrix3>(cells.count(), Matrix3::Zero()), false);
    const LocalGlobal::Outcome outcome = local_global.settle(constraints, 1e-8, 4000, displacement, rotations);
    EXPECT_LT(outcome.left, 1e-8) << membrane;

    const Eigen::MatrixXd m = system.differential_operator();
    Points rotated = Points::Zero(cells.count(), 3);
    for (int a = 0; a < cells.count(); ++a) {
      for (int b = 0; b < cells.count(); ++b) {
        const Vector3 edge = (cells.centres.row(a) - cells.centres.row(b)).transpose();
        const Matrix3 mean = 0.5 * (rotations[a] + rotations[b]);
        rotated.row(a) -= m(a, b) * (mean * edge - edge).transpose();  // nothing where a is b
      }
    }
    Points right = constraints, expected;
    system.add_rotated(rotated, right);
    system.solve(right, expected);
    EXPECT_LT(farthest(displacement, expected), 1e-6) << membrane;
    EXPECT_GT(farthest(displacement, Points::Zero(cells.count(), 3)), 3) << "nothing moved";
  }
}

/// Fails if a script's fractions jump: a step of the handle by 0.008 moves no cell by more than half as much again.
TEST(CellPose, PosesChangeEvenlyWithTheFraction) {
  const auto t = limb();
  HandleTransform push;
  push.translation = Vector3(-8, 0, 0);  // back into itself, where it buckles
  HandleMotion motion = resolve(push, Vector3::Zero());
  Points before;
  for (int k = 700; k <= 1000; ++k) {
    motion.fraction = k / 1000.0;
    t->solve({motion});
    if (before.rows() > 0) {
      EXPECT_LT(farthest(t->cells().displacement(), before), 0.012) << k;
    }
    before = t->cells().displacement();
  }
}

/// The first frame of a drag is often one in which nothing has moved.
TEST(CellPose, AllocatesNothingAfterASolutionForNothing) {
  const auto t = limb();
  t->solve({Affine::Identity()});
  const Maps maps = {bent(50)};
  const long before = allocations;
  t->solve(maps, true);
  EXPECT_EQ(allocations - before, 0);
}

/// A cell that hangs on one other has no tangent plane; what rounding makes of one is another normal in each pass, and
/// rotations never settle. Of a ribbon as narrow as its cells the last ones are such.
TEST(CellSurface, CellsWithNeighboursInALineHaveNoNormal) {
  const TriangleMesh ribbon = shapes::grid(200, 2);
  Turned t(support::moved(rigid(33, Vector3(1, 2, 3), Vector3::Zero()), ribbon), support::within(150), {{0, 1}},
           settled());
  ThreadPool pool(1);
  const RegionCells cells = make_cells(t.region, t.rest, CellPose::wanted_cells(t.region.size()), pool);
  const CellSurface surface(cells);
  int lone = 0;
  for (int c = 0; c < cells.count(); ++c) {
    const Vector3 normal = surface.normal(c, cells.centres);
    if (cells.neighbours[c].size() < 2) {
      ++lone;
      EXPECT_TRUE(normal.isZero(0)) << c;
    } else {
      EXPECT_TRUE(normal.isZero(0) || std::abs(normal.norm() - 1) < 1e-12) << c;
    }
  }
  EXPECT_GT(lone, 0) << "another region is needed";
}

/// A cell of two groups that move apart would have two places.
TEST(CellPacking, NeighbouringGroupsHaveCellsOfTheirOwn) {
  TriangleMesh mesh = shapes::cylinder(24, 60);
  mesh.vertices.col(0) *= 3;
  Turned t(mesh, support::component(), {where(mesh, 0, 0.5), where(mesh, 0.55, 1.2)}, settled());
  const RegionCells& cells = t.model.cells();
  std::vector<int> group(cells.count(), -1);
  int shared = 0;
  for (int i = 0; i < t.region.size(); ++i) {
    int& of = group[cells.of[i]];
    shared += t.region.group[i] >= 0 && of >= 0 && of != t.region.group[i];
    of = t.region.group[i] >= 0 ? t.region.group[i] : of;
  }
  EXPECT_EQ(shared, 0);
}

/// Fails if work or memory for cells grows with the number of groups beyond the usual number of cells, or if a cell of
/// a packing that was given up is used.
TEST(CellPacking, AnyNumberOfGroupsHasAFewHundredCells) {
  const TriangleMesh mesh = shapes::grid(60, 60);
  for (const int count : {300, 1300, 3000, 3599}) {
    std::vector<std::vector<int>> groups;
    for (int g = 0; g < count; ++g) {
      groups.push_back({3600 * g / count});
    }
    if (count == 1300) {
      groups[7] = where(mesh, 0.2, 5.2);  // larger groups keep their cells
      const auto is_other = [&](const std::vector<int>& group) {
        return group.size() > 1 || !std::binary_search(groups[7].begin(), groups[7].end(), group[0]);
      };
      groups.erase(std::stable_partition(groups.begin(), groups.end(), is_other), groups.end());
    }
    Turned t(mesh, support::component(), groups, settled());
    const RegionCells& cells = t.model.cells();
    EXPECT_LT(cells.count(), 1000) << count;
    for (const int of : cells.of) {
      ASSERT_GE(of, 0) << count;
      ASSERT_LT(of, cells.count()) << count;
    }
    EXPECT_EQ(groups_with_cells(t.region).size(), count == 300 ? 300U : count == 1300 ? 1U : 0U);
    Maps maps;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      maps.push_back({shift(Vector3(0, 0, std::sin(static_cast<double>(g))))});
    }
    t.solve(maps);
    EXPECT_TRUE(t.cells().displacement().allFinite()) << count;
  }
}

TEST(CellPose, SingularAndMirroringMapsGiveFiniteRotations) {
  const auto t = limb();
  for (const Vector3& scale : {Vector3(0, 0, 0), Vector3(1, 0, 1), Vector3(-1, 1, 1), Vector3(-1, -1, -1)}) {
    Affine map = shift(Vector3(1, 0, 2));
    map.linear() = scale.asDiagonal();
    t->solve({map});
    EXPECT_TRUE(t->cells().displacement().allFinite()) << scale.transpose();
    for (const Matrix3& rotation : t->spread()) {
      ASSERT_LT(support::rotation_defect(rotation), 1e-9) << scale.transpose();
    }
  }
  TriangleMesh mesh = shapes::cylinder(10, 20);
  Turned loose(mesh, support::component(), {where(mesh, 0, 0.5), where(mesh, 3.5, 4)}, settled());
  Affine flat = Affine::Identity();
  flat.linear() = Vector3(1, 1, 0).asDiagonal();
  loose.solve({flat, flat});  // carried by a map that has no inverse
  loose.solve({flat, Affine(flat * rigid(40, Vector3::UnitX(), Vector3(0, 1, 0)))});
  EXPECT_TRUE(loose.cells().displacement().allFinite());
  for (const Matrix3& rotation : loose.spread()) {
    ASSERT_LT(support::rotation_defect(rotation), 1e-9);
  }
}

/// In place, with another order of elimination, from the lower half alone.
TEST(SmallCholesky, AgreesWithADenseSolve) {
  constexpr int kSize = 40;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    dense(i, i) = 4;
    dense(i, i * 7 % kSize) += i * 7 % kSize == i ? 0 : -1;
  }
  dense = (dense * dense.transpose()).eval();
  const Points right =
      Points::NullaryExpr(kSize, 3, [](Eigen::Index i, Eigen::Index k) { return std::sin(i + 3.0 * k); });
  Points x = right;
  SmallCholesky(SparseMatrix(Eigen::MatrixXd(dense.triangularView<Eigen::Lower>()).sparseView())).solve(x, x);
  EXPECT_LT((dense * x - right).norm(), 1e-11);
  dense(30, 30) = -1;
  support::expect_refusal(ErrorCause::IllConditioned, [&] { SmallCholesky(SparseMatrix(dense.sparseView())); });
}

}  // namespace
}  // namespace lapedit::cell_pose_test
