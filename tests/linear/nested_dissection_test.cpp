// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/nested_dissection.h"

#include <gtest/gtest.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "mesh_support.h"
#include "shapes.h"

namespace lapedit {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Order = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;

/// A height field whose triangulation is far from a grid's: edges are turned at random where that can be done,
/// with as many trials as vertices.
TriangleMesh irregular_field(int nx, int ny) {
  TriangleMesh mesh = shapes::letter_field(nx, ny);
  std::map<std::pair<int, int>, int> face_left_of;
  const auto m = static_cast<unsigned>(mesh.faces.rows());
  for (int f = 0; f < static_cast<int>(m); ++f) {
    for (int k = 0; k < 3; ++k) face_left_of[{mesh.faces(f, k), mesh.faces(f, (k + 1) % 3)}] = f;
  }
  std::mt19937 random(3);
  for (int trial = 0; trial < nx * ny; ++trial) {
    const int f = static_cast<int>(random() % m), k = static_cast<int>(random() % 3);
    const int a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3), c = mesh.faces(f, (k + 2) % 3);
    const auto other = face_left_of.find({b, a});
    if (other == face_left_of.end()) continue;
    const int g = other->second;
    const int d = mesh.faces.row(g).sum() - a - b;
    const auto area = [&](int p, int q, int r) {
      const Vector3 along = mesh.vertices.row(q) - mesh.vertices.row(p);
      const Vector3 across = mesh.vertices.row(r) - mesh.vertices.row(p);
      return along.x() * across.y() - along.y() * across.x();
    };
    // Only where the two triangles make a convex quadrangle.
    const double sign = area(a, b, c);
    if (sign * area(c, a, d) <= 0 || sign * area(d, b, c) <= 0 || face_left_of.count({c, d}) != 0 ||
        face_left_of.count({d, c}) != 0) {
      continue;
    }
    face_left_of.erase({a, b});
    face_left_of.erase(other);
    mesh.faces.row(f) << c, a, d;
    mesh.faces.row(g) << d, b, c;
    for (const int face : {f, g}) {
      for (int e = 0; e < 3; ++e) face_left_of[{mesh.faces(face, e), mesh.faces(face, (e + 1) % 3)}] = face;
    }
  }
  return support::renumbered(mesh, support::shuffled(nx * ny, 4), 5);
}

/// L^T L + 1, L the graph's Laplacian.
Matrix normal_matrix(const IndexLists& neighbours) {
  const int n = neighbours.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < n; ++v) {
    entries.emplace_back(v, v, neighbours[v].size());
    for (const int w : neighbours[v]) entries.emplace_back(v, w, -1);
  }
  Matrix laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  Matrix identity(n, n);
  identity.setIdentity();
  return Matrix(laplacian.transpose()) * laplacian + identity;
}

/// Entries of the factor of a matrix eliminated in an order: the vertex order.indices()[k] k-th.
Eigen::Index factor_entries(const Matrix& matrix, const Order& order) {
  Matrix permuted;
  permuted = matrix.twistedBy(order.transpose());
  // Only the structure is asked for: the pattern's column counts, along the elimination tree (Liu 1990).
  const int n = static_cast<int>(permuted.cols());
  std::vector<int> parent(n, -1), mark(n, -1);
  Eigen::Index entries = n;
  for (int j = 0; j < n; ++j) {
    mark[j] = j;
    for (Matrix::InnerIterator entry(permuted, j); entry; ++entry) {
      for (int i = static_cast<int>(entry.row()); i < j && mark[i] != j; i = parent[i]) {
        if (parent[i] < 0) parent[i] = j;
        mark[i] = j;
        ++entries;
      }
    }
  }
  return entries;
}

Eigen::Index nested_entries(const TriangleMesh& mesh) {
  const IndexLists neighbours = support::adjacency_of(mesh).neighbours;
  const std::vector<int> order = nested_dissection(neighbours, mesh.vertices);
  Order permutation(static_cast<Eigen::Index>(order.size()));
  std::copy(order.begin(), order.end(), permutation.indices().data());
  return factor_entries(normal_matrix(neighbours), permutation);
}

Eigen::Index minimum_degree_entries(const TriangleMesh& mesh) {
  const Matrix matrix = normal_matrix(support::adjacency_of(mesh).neighbours);
  Order permutation;
  Eigen::AMDOrdering<int>()(matrix.selfadjointView<Eigen::Lower>(), permutation);
  return factor_entries(matrix, permutation);
}

void expect_permutation(std::vector<int> order, int n) {
  ASSERT_EQ(static_cast<int>(order.size()), n);
  std::sort(order.begin(), order.end());
  for (int k = 0; k < n; ++k) ASSERT_EQ(order[k], k);
}

TriangleMesh fan(int blades) {
  TriangleMesh mesh;
  mesh.vertices.resize(blades + 1, 3);
  mesh.faces.resize(blades, 3);
  for (int k = 0; k < blades; ++k) {
    mesh.vertices.row(k) << std::cos(0.01 * k), std::sin(0.01 * k), 0.001 * k;
    mesh.faces.row(k) << blades, k, (k + 1) % blades;
  }
  mesh.vertices.row(blades).setZero();
  return mesh;
}

TriangleMesh all_in_one_point() {
  TriangleMesh mesh = shapes::icosphere(5);
  mesh.vertices.setConstant(7);
  return mesh;
}

TriangleMesh points_in_no_order() {
  TriangleMesh mesh = shapes::grid(80, 80);
  const std::vector<int> positions = support::shuffled(6400, 1);
  mesh.vertices = support::rows(mesh.vertices, positions) * 1e200;
  return mesh;
}

TriangleMesh vertices_only(int count) {
  return {Points::Zero(count, 3), Faces(0, 3)};
}

TriangleMesh many_pieces() {
  TriangleMesh mesh = vertices_only(3000);
  mesh.faces.resize(800, 3);
  for (int f = 0; f < 800; ++f) mesh.faces.row(f) << 3 * f, 3 * f + 1, 3 * f + 2;
  return shapes::together(mesh, shapes::icosphere(4), Vector3(5, 0, 0));
}

TriangleMesh random_triangles() {
  TriangleMesh mesh{Points::Zero(1500, 3), Faces(3000, 3)};
  std::mt19937 random(1);
  for (int k = 0; k < 9000; ++k) mesh.faces(k / 3, k % 3) = static_cast<int>(random() % 1500);
  for (int k = 0; k < 4500; ++k) mesh.vertices(k / 3, k % 3) = random() % 1000;
  return mesh;
}

class NestedDissectionOn : public ::testing::TestWithParam<TriangleMesh (*)()> {};
INSTANTIATE_TEST_SUITE_P(
    Shapes, NestedDissectionOn,
    ::testing::Values([] { return shapes::letter_field(120, 60); }, [] { return shapes::icosphere(5); },
                      [] { return shapes::bar(40, 20, 10); }, [] { return shapes::tapered_arm(40, 200); },
                      [] { return shapes::cylinder(600, 10); }, [] { return shapes::grid(3, 3000); },
                      [] { return shapes::degenerate_grid(60, 80); }, [] { return shapes::non_manifold_grid(70, 60); },
                      [] { return shapes::two_pieces(4); }, [] { return fan(1500); }, [] { return fan(700); },
                      all_in_one_point, points_in_no_order, many_pieces, random_triangles,
                      [] { return vertices_only(3000); }, [] { return shapes::grid(2, 2); }));

TEST_P(NestedDissectionOn, NamesEachVertexOnceWhateverTheThreads) {
  const TriangleMesh mesh = GetParam()();
  const IndexLists neighbours = support::adjacency_of(mesh).neighbours;
  const std::vector<int> order = nested_dissection(neighbours, mesh.vertices);
  expect_permutation(order, static_cast<int>(mesh.vertices.rows()));
  for (const int threads : {2, 3, 0}) {
    EXPECT_EQ(nested_dissection(neighbours, mesh.vertices, threads), order) << threads << " threads";
  }
}

TEST(NestedDissection, TakesNoneAndOne) {
  for (const int n : {0, 1, 2}) {
    const TriangleMesh mesh = vertices_only(n);
    expect_permutation(nested_dissection(support::adjacency_of(mesh).neighbours, mesh.vertices), n);
  }
}

TEST(NestedDissection, DoesNotDependOnTheUnit) {
  const TriangleMesh mesh = shapes::letter_field(120, 60);
  const IndexLists neighbours = support::adjacency_of(mesh).neighbours;
  const std::vector<int> order = nested_dissection(neighbours, mesh.vertices);
  EXPECT_EQ(nested_dissection(neighbours, mesh.vertices * 0x1p40), order);
  EXPECT_EQ(nested_dissection(neighbours, mesh.vertices * 0x1p-900), order);
}

TEST(NestedDissection, CountsEntriesAsAFactorHasThem) {
  const TriangleMesh mesh = shapes::letter_field(30, 20);
  const Matrix matrix = normal_matrix(support::adjacency_of(mesh).neighbours);
  Order none(matrix.rows());
  none.setIdentity();
  const Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> factor(matrix);
  EXPECT_EQ(factor_entries(matrix, none), factor.matrixL().nestedExpression().nonZeros());
}

/// Fill over that of minimum degree.
double relative_fill(const TriangleMesh& mesh) {
  return static_cast<double>(nested_entries(mesh)) / static_cast<double>(minimum_degree_entries(mesh));
}

TEST(NestedDissection, FillsAboutAsMuchAsMinimumDegreeOnMiddlingMeshes) {
  EXPECT_LT(relative_fill(irregular_field(160, 80)), 1.1);
  EXPECT_LT(relative_fill(shapes::tapered_arm(60, 200)), 1.1);
  EXPECT_LT(relative_fill(shapes::icosphere(5)), 0.95);
}

TEST(NestedDissection, FillsLessThanMinimumDegreeOnLargeMeshes) {
  EXPECT_LT(relative_fill(irregular_field(284, 142)), 1);
  EXPECT_LT(relative_fill(shapes::icosphere(6)), 0.9);
}

TEST(NestedDissection, FillsLittleAroundVerticesOfManyNeighbours) {
  // Each cap is a clique of 600.
  EXPECT_LT(relative_fill(shapes::cylinder(600, 20)), 1.2);
}

TEST(NestedDissection, FillsLittleOnManyPieces) {
  EXPECT_LT(relative_fill(many_pieces()), 1.02);
}

TEST(NestedDissection, CutsAlsoWherePointsTellNothing) {
  EXPECT_LT(relative_fill(all_in_one_point()), 1.1);
}

}  // namespace
}  // namespace lapedit
