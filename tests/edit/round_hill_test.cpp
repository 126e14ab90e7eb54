// SPDX-License-Identifier: GPL-3.0-or-later
// Hills that are pulled from a regular grid are round.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lapedit/mesh/vertex_set.h"
#include "support.h"

namespace lapedit::round_hill_test {
namespace {

constexpr int kSide = 81, kMiddle = kSide / 2, kRadius = 32, kHeight = 8;

/// Squares with single diagonals, the worst of all grids along edges.
TriangleMesh field() {
  TriangleMesh mesh;
  mesh.vertices.resize(Eigen::Index{kSide} * kSide, 3);
  mesh.faces.resize(Eigen::Index{2} * (kSide - 1) * (kSide - 1), 3);
  int face = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const int a = j * kSide + i;
      mesh.vertices.row(a) << i - kMiddle, j - kMiddle, 0;
      if (i + 1 < kSide && j + 1 < kSide) {
        mesh.faces.row(face++) << a, a + 1, a + kSide + 1;
        mesh.faces.row(face++) << a, a + kSide + 1, a + kSide;
      }
    }
  }
  return mesh;
}

/// The largest deviation of the radius at which a hill has a fraction of its height, over the mean of 16 directions.
/// The handle is the tool's disc.
double deviation(LaplacianKind kind, double fraction) {
  const TriangleMesh mesh = field();
  const std::vector<int> disc = vertices_within(mesh, support::adjacency_of(mesh), kSide * kSide / 2, kRadius / 5.0);
  const Region region = support::region_of(mesh, support::within(kRadius), {disc});
  EditSettings settings;
  settings.laplacian = kind;
  support::Prepared solver(mesh, region, settings);
  const Points pose = solver.pose({support::shift({0, 0, kHeight})});
  Eigen::MatrixXd height = Eigen::MatrixXd::Zero(kSide, kSide);
  for (int i = 0; i < region.size(); ++i) {
    height(region.mesh_vertex[i] % kSide, region.mesh_vertex[i] / kSide) = pose(i, 2);
  }
  const auto at = [&](double x, double y) {
    const double column = std::floor(x), row = std::floor(y), u = x - column, v = y - row;
    const int i = static_cast<int>(column) + kMiddle, j = static_cast<int>(row) + kMiddle;
    return (1 - u) * ((1 - v) * height(i, j) + v * height(i, j + 1)) +
           u * ((1 - v) * height(i + 1, j) + v * height(i + 1, j + 1));
  };
  std::vector<double> radii;
  double mean = 0;
  for (int k = 0; k < 16; ++k) {
    const double angle = k * EIGEN_PI / 8, x = std::cos(angle), y = std::sin(angle);
    double radius = 0;
    while (radius < kRadius && at(radius * x, radius * y) > kHeight * fraction) {
      radius += 0.01;
    }
    radii.push_back(radius);
    mean += radius / 16;
  }
  const auto [least, most] = std::minmax_element(radii.begin(), radii.end());
  return std::max(mean - *least, *most - mean) / mean;
}

TEST(RoundHill, IsRoundWithinFivePercent) {
  for (const double fraction : {0.2, 0.35, 0.5}) {
    EXPECT_LT(deviation(LaplacianKind::Cotangent, fraction), 0.05) << fraction;
  }
  EXPECT_LT(deviation(EditSettings().laplacian, 0.2), 0.05);
}

/// The default operator itself depends on the direction of the diagonals, most near the handle.
TEST(RoundHill, IsRoundWithinSixPercentByDefault) {
  for (const double fraction : {0.35, 0.5}) {
    EXPECT_LT(deviation(EditSettings().laplacian, fraction), 0.06) << fraction;
  }
}

}  // namespace
}  // namespace lapedit::round_hill_test
