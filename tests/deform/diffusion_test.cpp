// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/diffusion.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "lapedit/deform/smooth_normals.h"
#include "shapes.h"
#include "support.h"

namespace lapedit {
namespace {

using support::mean_edge;

Region whole(const TriangleMesh& mesh) {
  return support::whole_region(mesh, {{0}}, {});
}

Points smoothed(const TriangleMesh& mesh, double radius, const Points& in, const CholeskyOptions& options = {}) {
  Points out;
  DiffusionSmoother(whole(mesh), mesh.vertices, radius, options).apply(in, out);
  return out;
}

/// The smoother as a matrix, three columns at a time.
Eigen::MatrixXd dense(const TriangleMesh& mesh, double radius) {
  const Eigen::Index n = mesh.vertices.rows();
  const DiffusionSmoother smoother(whole(mesh), mesh.vertices, radius);
  Eigen::MatrixXd result(n, n);
  Points in, out;
  for (Eigen::Index first = 0; first < n; first += 3) {
    in.setZero(n, 3);
    const Eigen::Index columns = std::min<Eigen::Index>(3, n - first);
    in.block(first, 0, columns, columns).setIdentity();
    smoother.apply(in, out);
    result.middleCols(first, columns) = out.leftCols(columns);
  }
  return result;
}

class DiffusionOn : public ::testing::TestWithParam<TriangleMesh (*)()> {};
INSTANTIATE_TEST_SUITE_P(Shapes, DiffusionOn,
                         ::testing::Values([] { return shapes::letter_field(24, 13); },
                                           [] { return shapes::icosphere(2); }, [] { return shapes::bar(6, 3, 3); },
                                           [] { return shapes::tapered_arm(10, 20); },
                                           [] { return shapes::degenerate_grid(12, 9); },
                                           [] { return shapes::non_manifold_grid(12, 9); },
                                           [] { return shapes::two_pieces(1); }));

/// Fails if masses enter one side of the equation only: weights of a mean sum to one.
TEST_P(DiffusionOn, KeepsAConstant) {
  const TriangleMesh mesh = GetParam()();
  const Points constant = Vector3(1, -2, 1e3).transpose().replicate(mesh.vertices.rows(), 1);
  for (const double edges : {0.3, 4.0, 40.0}) {
    EXPECT_LT((smoothed(mesh, edges * mean_edge(mesh), constant) - constant).cwiseAbs().maxCoeff(), 1e-9);
  }
}

/// Fails if a value is overshot (negative weights), a row does not sum to one, or pieces hear of each other.
TEST_P(DiffusionOn, IsAMeanOverTheOwnComponent) {
  const TriangleMesh mesh = GetParam()();
  std::vector<int> component;
  connected_components(support::adjacency_of(mesh).neighbours, component);
  for (const double edges : {0.3, 3.0, 12.0}) {
    const Eigen::MatrixXd weights = dense(mesh, edges * mean_edge(mesh));
    EXPECT_LT((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-11);
    EXPECT_GT(weights.minCoeff(), -1e-15);
    for (Eigen::Index i = 0; i < weights.rows(); ++i) {
      for (Eigen::Index j = 0; j < weights.cols(); ++j) {
        if (component[i] != component[j]) {
          ASSERT_EQ(weights(i, j), 0) << i << " and " << j << " are not connected";
        }
      }
    }
  }
}

/// Fails if a length enters that is none of the shape's, or a direction.
TEST_P(DiffusionOn, MovesWithTheShape) {
  const TriangleMesh mesh = GetParam()();
  const double radius = 4 * mean_edge(mesh);
  const Points result = smoothed(mesh, radius, mesh.vertices);
  for (const double scale : {1e-9, 1.0, 1e7}) {
    const Affine map = support::rigid(50, Vector3(1, 2, 3), scale * Vector3(4, -2, 9)) * Eigen::Scaling(scale);
    const TriangleMesh other = support::moved(map, mesh);
    EXPECT_LT(support::error(smoothed(other, scale * radius, other.vertices), support::moved(map, result)), 1e-11);
  }
}

/// Fails if the numbering enters by more than rounding, or an order given for the factorisation by more than that.
TEST_P(DiffusionOn, RenumberingPermutes) {
  const TriangleMesh mesh = GetParam()();
  const int n = static_cast<int>(mesh.vertices.rows());
  const std::vector<int> numbers = support::shuffled(n, 3);
  const TriangleMesh other = support::renumbered(mesh, numbers, 4);
  const double radius = 4 * mean_edge(mesh);
  const Points result = smoothed(mesh, radius, mesh.vertices);
  EXPECT_LT(support::error(support::rows(smoothed(other, radius, other.vertices), numbers), result), 1e-12);
  CholeskyOptions options;
  options.order = numbers;
  EXPECT_LT(support::error(smoothed(mesh, radius, mesh.vertices, options), result), 1e-12);
  options.backend = CholeskyBackend::Eigen;
  EXPECT_LT(support::error(smoothed(mesh, radius, mesh.vertices, options), result), 1e-12);
}

/// Fails if the time of the diffusion is not the one that makes it as wide as the paper's kernel, on meshes of any
/// density: the second moment of 2 t^3/r^3 - 3 t^2/r^2 + 1 over the disc is 5/21 r^2.
TEST(Diffusion, IsAsWideAsThePapersKernel) {
  constexpr int kSize = 81, kMiddle = kSize * (kSize / 2) + kSize / 2;
  const TriangleMesh mesh = shapes::grid(kSize, kSize);
  for (const double radius : {5.0, 8.0, 12.0}) {
    // The smoothed square of the distance from a vertex is the second moment about it.
    Points squares = Points::Zero(kSize * kSize, 3);
    squares.col(0) = (mesh.vertices.rowwise() - mesh.vertices.row(kMiddle)).rowwise().squaredNorm();
    const double kernel = 5.0 / 21 * radius * radius;
    EXPECT_NEAR(smoothed(mesh, radius, squares)(kMiddle, 0) / kernel, 1, 0.1) << "radius " << radius;
    Points by_kernel;
    SmoothingKernel(whole(mesh), mesh.vertices, radius, 1).apply(squares, by_kernel);
    EXPECT_GT(by_kernel(kMiddle, 0) / kernel, 0.6);  // its distances go along edges
    EXPECT_LT(by_kernel(kMiddle, 0) / kernel, 1.1);
  }
}

/// Fails if the noise is not smoothed, or smoothed with no regard to the radius.
TEST(Diffusion, SmoothsANoisyPlane) {
  constexpr int kSize = 40;
  TriangleMesh mesh = shapes::grid(kSize, kSize);
  std::mt19937 random(7);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 2) = 0.5 * (random() / 4294967295.0 - 0.5);
  }
  const auto largest_tilt = [&](const Points& points) {
    Points normals;
    vertex_normals(points, mesh.faces, normals);
    double largest = 0;
    for (int i = 8; i < kSize - 8; ++i) {
      for (int j = 8; j < kSize - 8; ++j) {
        largest = std::max(largest, normals.row(kSize * i + j).head(2).norm());
      }
    }
    return largest;
  };
  const double raw = largest_tilt(mesh.vertices);
  double before = raw;
  for (const double radius : {1.5, 3.0, 6.0}) {
    const double tilt = largest_tilt(smoothed(mesh, radius, mesh.vertices));
    EXPECT_LT(tilt, 0.8 * before) << "radius " << radius;
    before = tilt;
  }
  EXPECT_LT(before, 0.2 * raw);
}

/// Fails if vertices weigh by the area around them: the kernel's means are over vertices, dense parts weigh more.
TEST(Diffusion, MeansAreOverVertices) {
  TriangleMesh mesh = shapes::grid(41, 21);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
    mesh.vertices(v, 0) = mesh.vertices(v, 0) < 20 ? 15 + mesh.vertices(v, 0) / 4 : mesh.vertices(v, 0);
  }
  const double mean = mesh.vertices.col(0).mean();
  EXPECT_LT(mean, 24);  // the middle of the shape is at 27.5
  EXPECT_NEAR(smoothed(mesh, 1000, mesh.vertices)(0, 0), mean, 0.5);
}

/// Fails with anything not finite where edges have no length, vertices no edges, and radii are far off.
TEST(Diffusion, DegenerateShapesAreSmoothedToo) {
  TriangleMesh point = shapes::grid(6, 7), line = point, spike = shapes::icosphere(2);
  point.vertices.setOnes();
  line.vertices.rightCols(2).setZero();
  spike.vertices.row(5) *= 1e6;
  const TriangleMesh lone{Points::Random(5, 3), Faces(0, 3)};
  for (const TriangleMesh& mesh : {point, line, spike, lone, shapes::degenerate_grid(12, 9), shapes::grid(2, 2)}) {
    const double size = std::max(1.0, support::diameter(mesh.vertices));
    for (const double radius : {1e-6, 1.0, 1e3}) {
      const Points result = smoothed(mesh, radius, mesh.vertices);
      ASSERT_TRUE(result.allFinite()) << "radius " << radius;
      for (int k = 0; k < 3; ++k) {
        EXPECT_GT(result.col(k).minCoeff(), mesh.vertices.col(k).minCoeff() - 1e-6 * size);
        EXPECT_LT(result.col(k).maxCoeff(), mesh.vertices.col(k).maxCoeff() + 1e-6 * size);
      }
    }
  }
  EXPECT_LT((smoothed(lone, 1, lone.vertices) - lone.vertices).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace lapedit
