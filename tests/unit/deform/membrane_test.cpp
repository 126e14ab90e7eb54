// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/differential_operator.h"

#include <gtest/gtest.h>

#include <limits>

#include "shapes.h"
#include "support.h"

namespace lapedit::membrane_test {
namespace {

const double kPi = std::acos(-1.0);

/// The unit square in equilateral triangles of about 1 / n.
TriangleMesh square_of(int n) {
  const int rows = static_cast<int>(std::lround(n / std::sqrt(0.75)));
  TriangleMesh mesh = shapes::grid(n + 1, rows + 1);
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const double i = mesh.vertices(v, 0), j = mesh.vertices(v, 1);
    mesh.vertices.row(v) << (i + 0.5 * j) / n, j / rows, 0;
  }
  return mesh;
}

struct Energies {
  double factor = 0, bending = 0, stretching = 0;  // c; |M u|^2; u^T L u
  double ratio() const { return factor * stretching / bending; }
};

Energies energies(const TriangleMesh& mesh, const Eigen::VectorXd& u, LaplacianKind kind, int handle = 0) {
  const Region region = support::whole_region(mesh, {{handle}}, {});
  const DifferentialOperator op = differential_operator(kind, region, mesh, true);
  const Eigen::VectorXd bent = op.matrix * u;
  return {membrane_factor(100, region, mesh.vertices, op.mean), bent.squaredNorm(),
          u.dot(Eigen::VectorXd(op.divisor.cwiseProduct(bent)))};
}

/// sin^2(pi x) sin^2(pi y) over a sheared unit square: level at its border.
Eigen::VectorXd hill(const TriangleMesh& mesh) {
  const double shear = mesh.vertices(mesh.vertices.rows() - 1, 0) - 1;
  return (kPi * (mesh.vertices.col(0) - shear * mesh.vertices.col(1))).array().sin().square() *
         (kPi * mesh.vertices.col(1)).array().sin().square();
}

/// membrane / s^2 times |grad u|^2 / |Laplacian u|^2. Fails if the triangulation enters, or a factor is forgotten.
TEST(Membrane, RatioOfTheEnergiesIsThatOfTheSurfaces) {
  // For u = f(x - ty) g(y) over the sheared square, by a fine sum over a square of its parameters.
  constexpr int kFine = 400;
  const double t = std::sqrt(0.75) / 1.5;
  double gradient = 0, laplacian = 0;
  for (int a = 0; a < kFine; ++a) {
    for (int b = 0; b < kFine; ++b) {
      const double x = (a + 0.5) / kFine, y = (b + 0.5) / kFine;
      const auto value = [](double z) { return std::pow(std::sin(kPi * z), 2); };
      const auto slope = [](double z) { return kPi * std::sin(2 * kPi * z); };
      const auto bend = [](double z) { return 2 * kPi * kPi * std::cos(2 * kPi * z); };
      const double ux = slope(x) * value(y), uy = value(x) * slope(y) - t * ux;
      gradient += (ux * ux + uy * uy) / (kFine * kFine);
      const double along = bend(x) * value(y) * (1 + t * t), mixed = -2 * t * slope(x) * slope(y);
      laplacian += std::pow(along + mixed + value(x) * bend(y), 2) / (kFine * kFine);
    }
  }
  // s^2 is twice the mean squared distance from the centroid of x + ty, y.
  const double squared_size = 2 * (1.0 / 12) * (2 + t * t);
  const double expected = 100 / squared_size * gradient / laplacian;
  for (const LaplacianKind kind : {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
    for (const int n : {20, 40, 60}) {
      const TriangleMesh mesh = square_of(n);
      EXPECT_NEAR(energies(mesh, hill(mesh), kind).ratio() / expected, 1, n == 20 ? 0.1 : 0.05)
          << name(kind) << ", " << n;
    }
  }
}

/// Beside an equation of weight 1 a membrane never weighs more than 1, or handles would stay behind.
TEST(Membrane, OutweighsBendingNowhere) {
  for (const TriangleMesh& mesh : {shapes::grid(2, 2), shapes::icosphere(1), shapes::letter_field(30, 16)}) {
    const Region region = support::whole_region(mesh, {{0}}, {});
    EXPECT_NEAR(6 * membrane_factor(1e6, region, mesh.vertices, 6), 1, 1e-12);
    EXPECT_LT(6 * membrane_factor(0.1, region, mesh.vertices, 6), 0.1);
  }
}

TEST(Membrane, IsNoneWhereItIsNotAskedForOrMeansNothing) {
  const TriangleMesh mesh = shapes::grid(5, 5);
  Region region = support::whole_region(mesh, {{0}}, {});
  EXPECT_EQ(membrane_factor(0, region, mesh.vertices, 6), 0);
  EXPECT_EQ(membrane_factor(9, region, mesh.vertices, 0), 0);
  EXPECT_EQ(membrane_factor(9, region, Points::Zero(25, 3), 6), 0) << "a region without any size";
  EXPECT_EQ(membrane_factor(9, region, mesh.vertices, std::numeric_limits<double>::quiet_NaN()), 0);
  region.faces.resize(0, 3);
  EXPECT_EQ(membrane_factor(9, region, mesh.vertices, 6), 0);
}

}  // namespace
}  // namespace lapedit::membrane_test
