// SPDX-License-Identifier: GPL-3.0-or-later
// Hills that are pulled from a regular grid are round.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support.h"

namespace lapedit {
namespace {

constexpr int kSide = 81, kRadius = 32;

/// Squares with single diagonals, the worst of all grids along edges.
TriangleMesh field() {
  TriangleMesh mesh;
  mesh.vertices.resize(kSide * kSide, 3);
  mesh.faces.resize(2 * (kSide - 1) * (kSide - 1), 3);
  int face = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const int a = j * kSide + i;
      mesh.vertices.row(a) << i - kSide / 2, j - kSide / 2, 0;
      if (i + 1 < kSide && j + 1 < kSide) {
        mesh.faces.row(face++) << a, a + 1, a + kSide + 1;
        mesh.faces.row(face++) << a, a + kSide + 1, a + kSide;
      }
    }
  }
  return mesh;
}

/// Smallest and largest radius, over the mean, at which a height is crossed in 16 directions.
struct Roundness {
  double least, most;
};

Roundness roundness(LaplacianKind operator_kind) {
  const TriangleMesh mesh = field();
  const Region region = support::region_of(mesh, support::within(kRadius), {{kSide * kSide / 2}});
  EditSettings settings;
  settings.laplacian = operator_kind;
  support::Prepared solver(mesh, region, settings);
  const Points pose = solver.pose({support::shift({0, 0, 8})});
  Eigen::MatrixXd height = Eigen::MatrixXd::Zero(kSide, kSide);
  for (int i = 0; i < region.size(); ++i) {
    height(region.mesh_vertex[i] % kSide, region.mesh_vertex[i] / kSide) = pose(i, 2);
  }
  const auto at = [&](double x, double y) {
    const double column = std::floor(x), row = std::floor(y), u = x - column, v = y - row;
    const int i = static_cast<int>(column) + kSide / 2, j = static_cast<int>(row) + kSide / 2;
    return (1 - u) * ((1 - v) * height(i, j) + v * height(i, j + 1)) +
           u * ((1 - v) * height(i + 1, j) + v * height(i + 1, j + 1));
  };
  Roundness result{kUnreached, 0};
  for (const double fraction : {0.2, 0.35, 0.5}) {
    std::vector<double> radii;
    double sum = 0;
    for (int k = 0; k < 16; ++k) {
      const double angle = k * EIGEN_PI / 8, x = std::cos(angle), y = std::sin(angle);
      double radius = 0;
      while (at(radius * x, radius * y) > 8 * fraction && radius < kRadius) {
        radius += 0.01;
      }
      radii.push_back(radius);
      sum += radius / 16;
    }
    result.least = std::min(result.least, *std::min_element(radii.begin(), radii.end()) / sum);
    result.most = std::max(result.most, *std::max_element(radii.begin(), radii.end()) / sum);
  }
  return result;
}

TEST(RoundHill, IsRoundWithinFivePercent) {
  for (const LaplacianKind kind : {LaplacianKind::MeanValue, LaplacianKind::Cotangent}) {
    const Roundness found = roundness(kind);
    EXPECT_GE(found.least, 0.95) << name(kind);
    EXPECT_LE(found.most, 1.05) << name(kind);
  }
}

}  // namespace
}  // namespace lapedit
