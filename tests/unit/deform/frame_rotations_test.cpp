// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/frame_rotations.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "lapedit/base/polar_decomposition.h"
#include "lapedit/deform/smooth_normals.h"
#include "lapedit/mesh/surface_measures.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::frame_rotations_test {
namespace {

/// Rotations of a whole mesh from its own positions to others.
std::vector<Matrix3> rotations(const TriangleMesh& mesh, const Points& after, double radius) {
  const Region region = support::whole_region(mesh, {{0}}, {});
  const SmoothingKernel kernel(region, mesh.vertices, radius, 1);
  std::vector<Matrix3> result;
  FrameRotations(region, kernel).estimate(mesh.vertices, after - mesh.vertices, result);
  return result;
}

/// An irregular plane with waves: no ties between edges, nowhere flat.
TriangleMesh wavy_field(int nx, int ny) {
  TriangleMesh mesh = shapes::letter_field(nx, ny, 0);
  for (auto p : mesh.vertices.rowwise()) {
    p[2] = 0.15 * std::sin(3 * p[0] + 0.4) * std::cos(2.3 * p[1]);
  }
  return mesh;
}

std::vector<TriangleMesh> shapes_and_waves() {
  std::vector<TriangleMesh> all = support::all_shapes();
  all.push_back(wavy_field(24, 12));
  return all;
}

/// Edges of the degenerate grid are 1e-7 long, whose directions hold nine digits at most, and the frames may take one.
TEST(FrameRotations, RigidMotionIsRecovered) {
  for (const TriangleMesh& mesh : shapes_and_waves()) {
    const Adjacency adjacency = support::adjacency_of(mesh);
    const double tolerance = mesh.vertices.rows() == shapes::degenerate_grid(12, 9).vertices.rows() ? 1e-6 : 1e-9;
    for (const double degrees : {1e-4, 37.0, 120.0, 179.0}) {
      const Affine map = support::rigid(degrees, Vector3(1, -2, 0.5), Vector3(3, 1, -20));
      const auto found = rotations(mesh, support::moved(map, mesh.vertices), 3 * support::mean_edge(mesh));
      for (int v = 0; v < mesh.vertices.rows(); ++v) {
        const bool isolated = adjacency.neighbours[v].size() == 0;
        const Matrix3 expected = isolated ? Matrix3(Matrix3::Identity()) : Matrix3(map.linear());
        EXPECT_LT((found[v] - expected).norm(), isolated ? 1e-300 : tolerance) << degrees << ", vertex " << v;
      }
    }
  }
}

/// Whatever becomes of the surface, what comes out is a rotation.
TEST(FrameRotations, AreAlwaysRotations) {
  for (const TriangleMesh& mesh : shapes_and_waves()) {
    std::mt19937 generator(11);
    const double size = support::diameter(mesh.vertices);
    Points noise = mesh.vertices;
    for (Eigen::Index k = 0; k < noise.size(); ++k) {
      noise.data()[k] = size * (static_cast<double>(generator()) / 4294967295.0 - 0.5);
    }
    auto flattened = [&mesh](double x, double y, double z) {
      return Points(mesh.vertices * Vector3(x, y, z).asDiagonal());
    };
    const std::vector<std::pair<const char*, Points>> poses = {
        {"noise", noise},
        {"mirrored", flattened(-1, 1, 1)},
        {"turned inside out", flattened(-1, -1, -1)},
        {"flat", flattened(1, 0, 1)},
        {"on a line", flattened(0, 1, 0)},
        {"in a point", flattened(0, 0, 0)},
        {"tiny", flattened(1e-14, 1e-14, 1e-14)},
        {"vast", 1e8 * noise},
    };
    for (const auto& [pose, after] : poses) {
      for (const Matrix3& rotation : rotations(mesh, after, 3 * support::mean_edge(mesh))) {
        ASSERT_LT(support::rotation_defect(rotation), 1e-9) << pose;
      }
    }
  }
}

TEST(FrameRotations, FarFromWhatMovesIsExactlyTheIdentity) {
  const TriangleMesh mesh = wavy_field(60, 12);
  Points after = mesh.vertices;
  for (auto p : after.rowwise()) {
    if (p[0] > 3) {
      p = (p.array() * 1.3 + 0.2).matrix().eval();
    }
  }
  const auto found = rotations(mesh, after, 0.5);
  int rotated = 0, disturbed = 0;
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const bool is_rotated = found[v] != Matrix3(Matrix3::Identity());
    rotated += is_rotated;
    disturbed += is_rotated && mesh.vertices(v, 0) < 1.7;  // farther than the smoothing radius and some rings
  }
  EXPECT_EQ(disturbed, 0);
  EXPECT_GT(rotated, 100);
}

TEST(FrameRotations, PoseToRotateFromCanBeChanged) {
  const TriangleMesh mesh = wavy_field(24, 12);
  const Region region = support::whole_region(mesh, {{0}}, {});
  const SmoothingKernel kernel(region, mesh.vertices, 0.5, 1);
  const Affine first = support::rigid(70, Vector3(1, 1, 0), Vector3(1, 0, 0));
  const Affine second = support::rigid(25, Vector3(0, 1, 3), Vector3(0, 1, 0));
  const Points moved = support::moved(first, mesh.vertices);
  FrameRotations frames(region, kernel);
  std::vector<Matrix3> found;
  frames.estimate(mesh.vertices, moved - mesh.vertices, found);
  frames.estimate(moved, support::moved(second, moved) - moved, found);
  for (const Matrix3& rotation : found) {
    EXPECT_LT((rotation - second.linear()).norm(), 1e-9);
  }
}

/// Turned, stretched, flat, mirrored, symmetric and empty matrices, of all sizes, also in lists that end within a
/// vector.
TEST(NearestRotations, AreThePolarFactors) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<Matrix3> matrices(5003);
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    Matrix3 noise = Matrix3::NullaryExpr([&] { return normal(random); });
    Matrix3 turned = noise * noise.transpose();
    turned += 0.01 * turned.norm() * Matrix3::Identity();
    turned = polar_rotation(noise) * turned;
    noise.col(2) *= i % 3 == 0 ? 1e-7 : 1;
    const Matrix3 kinds[] = {turned,         turned, noise + noise.transpose(), noise, noise * noise.transpose(),
                             Matrix3::Zero()};
    matrices[i] = std::exp(9 * normal(random)) * kinds[random() % 6];
  }
  std::vector<Matrix3> found = matrices;
  nearest_rotations(found.data(), 5003, found.data());
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    const Matrix3& matrix = matrices[i];
    EXPECT_EQ(nearest_rotation(matrix), found[i]) << i;
    if (matrix == matrix.transpose() && matrix.llt().info() == Eigen::Success) {
      EXPECT_EQ(found[i], Matrix3(Matrix3::Identity())) << i;
    } else if (matrix.norm() > 0) {
      const Matrix3 expected = polar_rotation(matrix);
      EXPECT_LT(support::rotation_defect(found[i]), 1e-12) << i;
      EXPECT_GE(found[i].cwiseProduct(matrix).sum(), (1 - 1e-7) * expected.cwiseProduct(matrix).sum()) << i;
    }
  }
  for (const int count : {8, 7, 0}) {
    std::vector<Matrix3> some(9, Matrix3::Constant(-3));
    nearest_rotations(matrices.data(), count, some.data());
    for (int i = 0; i < 9; ++i) {
      EXPECT_EQ(some[i], i < count ? found[i] : Matrix3(Matrix3::Constant(-3))) << i;
    }
  }
}

Region whole(const TriangleMesh& mesh, int handle = 0) {
  return support::whole_region(mesh, {{handle}}, {});
}

TEST(VertexNormals, OppositeFacesCancelToZeroNotToNoise) {
  // Two faces of one edge folded onto each other, tilted so that nothing cancels bit for bit.
  TriangleMesh mesh = support::mesh_of({0, 0, 0, 1, 0, 0, 0.3, 1, 0, 0.3, 1, 0}, {0, 1, 2, 1, 0, 3});
  mesh.vertices = support::moved(support::rigid(33, Vector3(1, 2, 3), Vector3(0.1, 0.2, 0.3)), mesh.vertices);
  Points normals;
  vertex_normals(mesh.vertices, mesh.faces, normals);
  EXPECT_EQ(Vector3(normals.row(0)), Vector3(0, 0, 0));
  EXPECT_NEAR(normals.row(2).norm(), 1, 1e-14);
}

TEST(VertexNormals, AreZeroWhereThereIsNoArea) {
  const TriangleMesh mesh = shapes::degenerate_grid(12, 9);
  Points normals;
  vertex_normals(mesh.vertices, mesh.faces, normals);
  ASSERT_TRUE(normals.allFinite());
  for (int v = 0; v < mesh.vertices.rows(); ++v) {
    const bool isolated = v >= mesh.vertices.rows() - 5;
    EXPECT_NEAR(normals.row(v).norm(), isolated ? 0 : 1, 1e-12) << "vertex " << v;
  }
}

TEST(SmoothingKernel, SampledOneIsNearTheExactOne) {
  for (const TriangleMesh& mesh : support::all_shapes()) {
    const Region region = whole(mesh);
    Points exact, sampled, scratch;
    const double r = 6 * support::mean_edge(mesh);
    SmoothingKernel(region, mesh.vertices, r, 1, std::numeric_limits<std::size_t>::max())
        .apply(mesh.vertices, exact, scratch);
    SmoothingKernel(region, mesh.vertices, r, 1, 1).apply(mesh.vertices, sampled, scratch);
    // Blending shifts a mean by less than the distance to the centres, r / 4, and mostly cancels; up to 0.11 r was
    // seen.
    EXPECT_LT((exact - sampled).rowwise().norm().maxCoeff(), 0.15 * r);
  }
}

TEST(AutomaticNormalRadius, FollowsTheSizeOfTheModel) {
  const TriangleMesh mesh = shapes::letter_field(40, 20);
  const double radius = automatic_normal_radius(whole(mesh, 410), mesh.vertices);
  for (const double scale : {1e-9, 1e-3, 1e6}) {
    const TriangleMesh other = support::moved(Affine(Eigen::Scaling(scale)), mesh);
    EXPECT_NEAR(automatic_normal_radius(whole(other, 410), other.vertices) / (scale * radius), 1, 1e-12);
  }
}

TEST(AutomaticNormalRadius, CoversTheDetailButNotTheRegion) {
  // Bumps of 8 x 8 in a region that reaches 50 to both sides of the handle.
  const TriangleMesh bumpy = shapes::bumpy_grid();
  std::vector<int> handle;
  handle.reserve(60);
  for (int j = 0; j < 60; ++j) {
    handle.push_back(60 * 50 + j);
  }
  const double radius = automatic_normal_radius(support::whole_region(bumpy, {handle}, {}), bumpy.vertices);
  EXPECT_GT(radius, 8);
  EXPECT_LT(radius, 25);
  // A region of a few edges still has neighbours to smooth over.
  const TriangleMesh mesh = shapes::grid(20, 20);
  const Region small = support::region_of(mesh, support::within(2), {{210}});
  EXPECT_GT(automatic_normal_radius(small, support::rows(mesh.vertices, small.mesh_vertex)), 2);
}

TEST(AutomaticNormalRadius, IsPositiveWhereAllVerticesCoincide) {
  TriangleMesh mesh = shapes::grid(4, 4);
  mesh.vertices.setOnes();
  EXPECT_GT(automatic_normal_radius(whole(mesh), mesh.vertices), 0);
}

}  // namespace
}  // namespace lapedit::frame_rotations_test
