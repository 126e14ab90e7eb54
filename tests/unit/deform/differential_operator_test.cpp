// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/differential_operator.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <set>

#include "shapes.h"
#include "support.h"

namespace lapedit::differential_operator_test {
namespace {

Region whole(const TriangleMesh& mesh) {
  return support::whole_region(mesh, {{0}}, {});
}

Eigen::MatrixXd dense(const DifferentialOperator& op) {
  return Eigen::MatrixXd(op.matrix);
}

template <class Check>
void for_each_operator(const Check& check) {
  for (const TriangleMesh& mesh : support::all_shapes()) {
    for (const LaplacianKind kind : {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
      check(mesh, whole(mesh), kind);
    }
  }
}

TEST(DifferentialOperator, RowsSumToZeroWithOnesOnTheDiagonalAndNoPositiveNeighbour) {
  for_each_operator([](const TriangleMesh& mesh, const Region& region, LaplacianKind kind) {
    const Eigen::MatrixXd m = dense(differential_operator(kind, region, mesh));
    for (int j = 0; j < region.size(); ++j) {
      if (region.neighbours[j].size() == 0) {
        EXPECT_TRUE(m.row(j).isZero(0)) << "isolated vertex " << j;
        continue;
      }
      EXPECT_NEAR(m.row(j).sum(), 0, 1e-14) << name(kind) << ", row " << j;
      EXPECT_EQ(m(j, j), 1) << name(kind) << ", row " << j;
      for (int i = 0; i < region.size(); ++i) {
        EXPECT_TRUE(i == j || m(j, i) <= 0) << name(kind) << ", entry " << j << ", " << i;
      }
      for (const int i : region.neighbours[j]) {
        EXPECT_TRUE(kind != LaplacianKind::Umbrella || m(j, i) == -1.0 / region.neighbours[j].size()) << j;
      }
    }
  });
}

/// With D its rows' sums, D M is symmetric: what the membrane's energy needs. Fails if an edge has another weight
/// in each direction, or a negative one.
TEST(DifferentialOperator, IsSymmetricAndPositive) {
  for_each_operator([](const TriangleMesh& mesh, const Region& region, LaplacianKind kind) {
    const EdgeWeights weights = edge_weights(kind, region, mesh);
    EXPECT_EQ(weights.values.size(), region.neighbours.values.size());
    for (const double weight : weights.values) {
      EXPECT_TRUE(weight > 0 || (weight == 0 && kind == LaplacianKind::Cotangent)) << name(kind);
    }
    const DifferentialOperator found = differential_operator(kind, region, mesh, true);
    const Eigen::MatrixXd stiffness = found.divisor.asDiagonal() * dense(found);
    EXPECT_TRUE(stiffness.allFinite()) << name(kind);
    EXPECT_LT((stiffness - stiffness.transpose()).cwiseAbs().maxCoeff(), 1e-15 * found.divisor.maxCoeff())
        << name(kind);
    EXPECT_TRUE((found.divisor.array() >= 0).all()) << name(kind);
  });
}

/// In a rhombus without its short diagonal both angles opposite to the long one (0-1) are 120 degrees.
TEST(DifferentialOperator, ObtusePairsCountAsZeroWithCotangentsOnly) {
  TriangleMesh mesh =
      support::mesh_of({-std::sqrt(3.0), 0, 0, std::sqrt(3.0), 0, 0, 0, 1, 0, 0, -1, 0}, {0, 1, 2, 1, 0, 3});
  const DifferentialOperator cotangent = differential_operator(LaplacianKind::Cotangent, whole(mesh), mesh);
  EXPECT_EQ(dense(cotangent)(0, 1), 0);
  EXPECT_NEAR(dense(cotangent)(0, 2), -0.5, 1e-15);
  EXPECT_NEAR(dense(cotangent)(0, 3), -0.5, 1e-15);
  EXPECT_LT(dense(differential_operator(LaplacianKind::MeanValue, whole(mesh), mesh, true))(0, 1), -0.1);
}

TEST(DifferentialOperator, CornersThatAreNoNumbersOutsideTheRegionAreIgnored) {
  TriangleMesh mesh = shapes::grid(9, 9);
  const Region region = support::region_of(mesh, support::within(2), {{40}});
  const std::set<int> inside(region.mesh_vertex.begin(), region.mesh_vertex.end());
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    if (!inside.count(v)) {
      mesh.vertices.row(v).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
  }
  for (const LaplacianKind kind : {LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
    const DifferentialOperator found = differential_operator(kind, region, mesh, kind == LaplacianKind::MeanValue);
    EXPECT_TRUE(dense(found).allFinite()) << name(kind);
    EXPECT_TRUE(found.divisor.allFinite()) << name(kind);
  }
}

TEST(MeanValueOperator, WeightsAreCutAndBadTrianglesTakeTheUniformOne) {
  const TriangleMesh bad = shapes::degenerate_grid(12, 9);
  const Region region = whole(bad);
  const EdgeWeights mean_value = edge_weights(LaplacianKind::MeanValue, region, bad);
  const double uniform = 2 / std::sqrt(3.0);
  int cut = 0;
  for (std::size_t e = 0; e < mean_value.values.size(); ++e) {
    EXPECT_GE(mean_value.values[e], 0.999e-3 * uniform);
    EXPECT_LE(mean_value.values[e], 1.001e3 * uniform);
    cut += mean_value.values[e] > 0.999e3 * uniform;
    EXPECT_TRUE(!mean_value.uniform[e] || std::abs(mean_value.values[e] - uniform) < 1e-15);
  }
  EXPECT_GT(cut, 0) << "needles of 1e-7";
}

/// A region of 0, 1 and 4 of which 1 has a weight towards 4 but none towards 0, so that only row 0 becomes uniform.
TEST(EdgeWeights, CotangentsTakeTheLargerOfAnEdgesTwoWhereTheyHaveToBeSymmetric) {
  const double side = std::sqrt(3.0);
  const TriangleMesh mesh =
      support::mesh_of({-side, 0, 0, side, 0, 0, 0, 1, 0, 0, -1, 0, side, -2, 0}, {0, 1, 2, 1, 0, 3, 1, 3, 4});
  const Region region = support::region_of(mesh, support::given({0, 1, 4}), {{1}});
  const auto weight = [&](const EdgeWeights& weights, int from, int to) {
    for (int e = region.neighbours.offsets[from]; e < region.neighbours.offsets[from + 1]; ++e) {
      if (region.neighbours.values[e] == to) {
        return weights.values[e];
      }
    }
    return -1.0;
  };
  const EdgeWeights plain = edge_weights(LaplacianKind::Cotangent, region, mesh);
  const EdgeWeights symmetric = edge_weights(LaplacianKind::Cotangent, region, mesh, true);
  EXPECT_NEAR(weight(plain, 0, 1), 1 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(weight(plain, 1, 0), 0);
  EXPECT_NEAR(weight(symmetric, 0, 1), 1 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(weight(symmetric, 1, 0), weight(symmetric, 0, 1));
  EXPECT_GT(weight(plain, 1, 2), 0);
  EXPECT_EQ(weight(symmetric, 1, 2), weight(plain, 1, 2)) << "as it was";
  EXPECT_EQ(weight(symmetric, 2, 1), weight(plain, 2, 1));
}

TEST(CotangentOperator, NeedlesAreCut) {
  // Two triangles on edge 0-1: a needle with a corner of 0.0057 degrees opposite to it, whose cotangent is 10,000, and
  // an equilateral one.
  TriangleMesh mesh = support::mesh_of({0, 0, 0, 1, 0, 0, 0.5, std::sqrt(0.75), 0, 0, -1e4, 0}, {0, 1, 2, 1, 0, 3});
  const DifferentialOperator found = differential_operator(LaplacianKind::Cotangent, whole(mesh), mesh);
  const double equilateral = 0.5 / std::sqrt(3.0), cut = 0.5 * 1e3 + equilateral;
  EXPECT_NEAR(dense(found)(0, 1), -cut / (cut + equilateral + 0.5e-4), 1e-12);
}

TEST(CotangentOperator, DegenerateTrianglesTakeTheUniformWeight) {
  // A square of two right triangles and, on its side 0-1, a triangle without area.
  TriangleMesh mesh = support::mesh_of({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 0, 0}, {0, 1, 2, 1, 3, 2, 0, 4, 1});
  const DifferentialOperator found = differential_operator(LaplacianKind::Cotangent, whole(mesh), mesh);
  const Eigen::MatrixXd m = dense(found);
  EXPECT_EQ(m(4, 0), -0.5);
  EXPECT_EQ(m(4, 1), -0.5);
  const double uniform = 1 / std::sqrt(3.0);  // against cot 45 / 2 of edge 0-2
  EXPECT_NEAR(m(0, 1), -uniform / (2 * uniform + 0.5), 1e-15);
  EXPECT_NEAR(m(0, 2), -0.5 / (2 * uniform + 0.5), 1e-15);
}

/// Beside an equation of weight 1 a membrane never weighs more than 1, or handles would stay behind.
TEST(Membrane, OutweighsBendingNowhere) {
  for (const TriangleMesh& mesh : {shapes::grid(2, 2), shapes::icosphere(1), shapes::letter_field(30, 16)}) {
    const Region region = whole(mesh);
    EXPECT_NEAR(6 * membrane_factor(1e6, region, mesh.vertices, 6), 1, 1e-12);
    EXPECT_LT(6 * membrane_factor(0.1, region, mesh.vertices, 6), 0.1);
  }
}

TEST(Membrane, IsNoneWhereItIsNotAskedForOrMeansNothing) {
  const TriangleMesh mesh = shapes::grid(5, 5);
  Region region = whole(mesh);
  EXPECT_EQ(membrane_factor(0, region, mesh.vertices, 6), 0);
  EXPECT_EQ(membrane_factor(9, region, mesh.vertices, 0), 0);
  EXPECT_EQ(membrane_factor(9, region, Points::Zero(25, 3), 6), 0) << "a region without any size";
  EXPECT_EQ(membrane_factor(9, region, mesh.vertices, std::numeric_limits<double>::quiet_NaN()), 0);
  region.faces.resize(0, 3);
  EXPECT_EQ(membrane_factor(9, region, mesh.vertices, 6), 0);
}

}  // namespace
}  // namespace lapedit::differential_operator_test
