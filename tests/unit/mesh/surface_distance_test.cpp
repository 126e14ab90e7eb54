// SPDX-License-Identifier: GPL-3.0-or-later
// Distances on a surface against the exact ones of plane and folded grids.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "lapedit/mesh/geodesic.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::surface_distance_test {
namespace {

constexpr double kMostTooLong = 1.085;
constexpr double kRounding = 1e-12;

enum class Diagonals { Single, Alternating, Rows };

/// A plane grid of rectangles, each cut along a diagonal, in space.
/// @param x,y  coordinates of its columns and rows
TriangleMesh plane_grid(const std::vector<double>& x, const std::vector<double>& y, Diagonals diagonals, double turn) {
  const int columns = static_cast<int>(x.size()), rows = static_cast<int>(y.size());
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized()) * Eigen::AngleAxisd(turn, Vector3::UnitZ()))
          .toRotationMatrix();
  TriangleMesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(columns) * rows, 3);
  mesh.faces.resize(static_cast<Eigen::Index>(2) * (columns - 1) * (rows - 1), 3);
  int face = 0;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      mesh.vertices.row(j * columns + i) = (rotation * Vector3(x[i], y[j], 0)).transpose();
      if (i + 1 == columns || j + 1 == rows) {
        continue;
      }
      const int a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
      const bool rises = diagonals == Diagonals::Single || (diagonals == Diagonals::Rows ? j : i + j) % 2 == 0;
      mesh.faces.row(face++) << a, b, rises ? d : c;
      mesh.faces.row(face++) << (rises ? a : b), d, c;
    }
  }
  return mesh;
}

std::vector<double> even(int count, double step) {
  std::vector<double> result(count);
  for (int i = 0; i < count; ++i) {
    result[i] = i * step;
  }
  return result;
}

/// Steps that grow from 1 to 1:ratio and shrink again, by a factor from one to the next.
std::vector<double> uneven(int count, double factor, double ratio) {
  std::vector<double> result{0};
  double step = 1;
  for (bool grows = true; static_cast<int>(result.size()) < count;) {
    result.push_back(result.back() + step);
    grows = grows ? step * factor <= ratio : step / factor < 1;
    step = grows ? step * factor : step / factor;
  }
  return result;
}

/// @param unfolded  the vertices in a plane
void expect_near_exact(const TriangleMesh& mesh, int seed, const Points& unfolded) {
  const Adjacency adjacency = support::adjacency_of(mesh);
  GeodesicSearch search({mesh, adjacency});
  search.run({seed}, kUnreached);
  double longest = 0, shortest = kUnreached;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    if (v != seed) {
      const double ratio = search.distance(v) / (unfolded.row(v) - unfolded.row(seed)).norm();
      longest = std::max(longest, ratio);
      shortest = std::min(shortest, ratio);
    }
  }
  EXPECT_LE(longest, kMostTooLong);
  EXPECT_GE(shortest, 1 - kRounding);
}

void expect_near_exact(const TriangleMesh& mesh, int seed) {
  expect_near_exact(mesh, seed, mesh.vertices);
}

TEST(SurfaceDistance, IsNearlyExactOnGridsOfAnyTurn) {
  for (const Diagonals diagonals : {Diagonals::Single, Diagonals::Alternating, Diagonals::Rows}) {
    for (const double ratio : {1.0, 1.2, 1.5, 1.8, 2.0, 2.2, 2.5, 2.8, 3.0, 3.3, 3.6, 4.0}) {
      for (const int count : {21, 61}) {
        for (const double turn : {0.0, 0.3, 0.79, 2.0}) {
          SCOPED_TRACE("diagonals " + std::to_string(static_cast<int>(diagonals)) + ", cells 1:" +
                       std::to_string(ratio) + ", " + std::to_string(count) + " rows, turn " + std::to_string(turn));
          const TriangleMesh mesh = plane_grid(even(count, ratio), even(count, 1), diagonals, turn);
          const int middle = count / 2 * count + count / 2;
          expect_near_exact(mesh, middle);
          expect_near_exact(mesh, middle + 1);
          expect_near_exact(mesh, count + 1);
        }
      }
    }
  }
}

TEST(SurfaceDistance, IsNearlyExactOnIrregularAndFoldedGrids) {
  constexpr int kCount = 41;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> some(-0.2, 0.2);
  for (const Diagonals diagonals : {Diagonals::Single, Diagonals::Alternating, Diagonals::Rows}) {
    TriangleMesh flat = plane_grid(even(kCount, 1), even(kCount, 1), diagonals, 0), folded = flat;
    const Eigen::RowVector3d x = flat.vertices.row(1) - flat.vertices.row(0);
    const Eigen::RowVector3d y = flat.vertices.row(kCount) - flat.vertices.row(0);
    Points unfolded = flat.vertices;
    Eigen::RowVector3d at(0, 0, 0);
    double angle = 0;
    for (int i = 0; i < kCount; ++i) {
      for (int j = 0; j < kCount; ++j) {
        const int v = j * kCount + i;
        const double along = j > 0 && j + 1 < kCount ? some(random) : 0;
        unfolded.row(v) = Eigen::RowVector3d(i, j + along, 0);
        folded.vertices.row(v) = at + Eigen::RowVector3d(0, 0, j + along);
        flat.vertices.row(v) += along * y + (i > 0 && i + 1 < kCount ? some(random) : 0) * x;
      }
      angle += 4 * some(random);
      at += Eigen::RowVector3d(std::cos(angle), std::sin(angle), 0);
    }
    for (const int seed : {20 * kCount + 20, 5 * kCount + 30, kCount + 1}) {
      expect_near_exact(flat, seed);
      expect_near_exact(folded, seed, unfolded);
    }
  }
}

/// Strips of thin cells, one on another: they share the vertices of every other column.
TriangleMesh books(int pages) {
  constexpr int kColumns = 13, kRows = 5;
  TriangleMesh mesh;
  for (int page = 0; page < pages; ++page) {
    mesh = shapes::together(mesh, plane_grid(even(kColumns, 0.15), even(kRows, 1), Diagonals::Single, 0),
                            Vector3(0, 0, 0.1 * page));
  }
  mesh.faces = mesh.faces.unaryExpr([](int v) { return v % kColumns % 2 == 0 ? v % (kColumns * kRows) : v; }).eval();
  return mesh;
}

TriangleMesh with_copies(const TriangleMesh& mesh, int copies, Eigen::Index faces) {
  return {mesh.vertices, mesh.faces.topRows(faces).replicate(copies, 1)};
}

TEST(SurfaceDistance, EqualsTryingAllLinesWhereFacesAreUnevenOrShareEdges) {
  for (const TriangleMesh& mesh :
       {books(2), books(3), plane_grid(uneven(15, 1.5, 4), even(15, 1), Diagonals::Alternating, 0.4)}) {
    support::expect_plain_distances(mesh, true);
  }
}

TEST(SurfaceDistance, FieldHasTheBitsOfTheSearch) {
  TriangleMesh mesh = shapes::together(books(3), shapes::letter_field(90, 70), Vector3(0, 0, 9));
  for (const TriangleMesh& shape : support::all_shapes()) {
    mesh = shapes::together(mesh, shape, Vector3(0, 0, 9));
  }
  const int n = static_cast<int>(mesh.vertices.rows());
  const Adjacency adjacency = support::adjacency_of(mesh);
  std::vector<int> many;
  std::vector<char> allowed(n, 1);
  for (int v = 0; v < n; ++v) {
    allowed[v] = v % 11 != 0;
    if (v % 9 == 1) {
      many.push_back(v);
    }
  }
  for (const PathGraph& graph : {PathGraph(mesh, adjacency), PathGraph(adjacency.neighbours, mesh.vertices)}) {
    GeodesicSearch search(graph);
    for (const int threads : {1, 2, 5}) {
      ThreadPool pool(threads);
      for (const std::vector<int>& seeds : {std::vector<int>{}, {4, 4}, {n - 1, 20}, many}) {
        for (const std::vector<char>* only : {static_cast<std::vector<char>*>(nullptr), &allowed}) {
          double cutoff = kUnreached;
          for (int pass = 0; pass < 3; ++pass) {
            const std::vector<int> reached = search.run(seeds, cutoff, only);
            const DistanceField field(graph, seeds, cutoff, only, pool);
            for (int v = 0; v < n; ++v) {
              ASSERT_EQ(field[v], search.distance(v)) << "vertex " << v << ", " << threads << " threads";
            }
            cutoff = reached.empty() ? 0 : search.distance(reached[reached.size() / 2]);  // exactly a vertex's
          }
        }
      }
    }
  }
}

TEST(SurfaceDistance, LinesGrowWithTheFacesWhereManyShareEdges) {
  const auto lines_per_face = [](TriangleMesh mesh, const TriangleMesh& others) {
    mesh.faces.conservativeResize(mesh.faces.rows() + others.faces.rows(), 3);
    mesh.faces.bottomRows(others.faces.rows()) = others.faces;
    const Adjacency adjacency = support::adjacency_of(mesh);
    const SurfaceLines lines(mesh.vertices, mesh.faces, adjacency.faces);
    std::size_t tried = 0;
    const auto known = [&tried](int) { return ++tried, kUnreached; };
    for (int v = 0; v < static_cast<int>(mesh.vertices.rows()); ++v) {
      lines.from(v, 0, nullptr, known, [](int, double) {});
    }
    return static_cast<double>(tried) / static_cast<double>(mesh.faces.rows());
  };
  const TriangleMesh none, page = books(1);
  const double usual = lines_per_face(page, none);
  for (const int pages : {2, 3, 8, 50}) {
    EXPECT_LT(lines_per_face(books(pages), none), 2 * usual) << pages << " pages";
  }
  for (const int copies : {1, 2, 6}) {
    EXPECT_LT(lines_per_face(page, with_copies(page, copies, page.faces.rows())), 2 * usual) << copies << " copies";
  }
  EXPECT_LT(lines_per_face(page, with_copies(page, 300, 1)), 2 * usual) << "one face listed 301 times";
}

/// The fan around a vertex of many faces is not searched again for each of its edges.
TEST(SurfaceDistance, LargeFansTakeNoLonger) {
  constexpr int kCount = 40000;
  TriangleMesh mesh;
  mesh.vertices.resize(kCount + 1, 3);
  mesh.faces.resize(kCount, 3);
  mesh.vertices.row(kCount).setZero();
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2 * EIGEN_PI * i / kCount;
    mesh.vertices.row(i) << std::cos(angle), std::sin(angle), 0.1;
    mesh.faces.row(i) << i, (i + 1) % kCount, kCount;
  }
  const Adjacency adjacency = support::adjacency_of(mesh);
  GeodesicSearch search({mesh, adjacency});
  EXPECT_EQ(search.run({0}, kUnreached).size(), kCount + 1U);
}

}  // namespace
}  // namespace lapedit::surface_distance_test
