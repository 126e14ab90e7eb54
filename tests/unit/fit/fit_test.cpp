// SPDX-License-Identifier: GPL-3.0-or-later
// What needs the inside; tests/cli/fits_test.py has whole fits.
#include "lapedit/fit/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "bodies.h"
#include "lapedit/base/error.h"
#include "lapedit/base/trigonometry.h"
#include "lapedit/fit/slide.h"
#include "lapedit/fit/template_energy.h"
#include "mesh_support.h"
#include "shapes.h"

namespace lapedit {
namespace {

/// A head of about 2,000 vertices, and its warp in another triangulation.
const TriangleMesh& head() {
  static const TriangleMesh mesh = shapes::head(0.075);
  return mesh;
}
const TriangleMesh& scan() {
  static const TriangleMesh mesh = [] {
    TriangleMesh warped = shapes::head(0.067);
    for (auto p : warped.vertices.rowwise()) {
      p = Eigen::RowVector3d(p[0] * (1.06 + 0.05 * std::sin(1.9 * p[1])) + 0.04 * std::sin(1.3 * p[2]),
                             0.97 * p[1] + 0.05 * std::sin(1.7 * p[0] + 0.4), p[2]);
    }
    return warped;
  }();
  return mesh;
}

Region whole_head() {
  RegionSpec spec;
  spec.kind = RegionSpec::Kind::Component;
  return build_region(head(), support::adjacency_of(head()), spec, {{0}});
}

FitResult fitted(const ScanFitSettings& settings = {}, int threads = 1, const Progress& progress = {}) {
  static const Region region = whole_head();
  static const Scan surface({scan(), {}});
  return fit_template({head(), region, surface, settings, {}, {}, threads}, progress);
}

TEST(Fit, HasTheSameBitsForAnyNumberOfThreads) {
  for (const FitMode mode : {FitMode::Shape, FitMode::Pose}) {
    ScanFitSettings settings;
    settings.mode = mode;
    EXPECT_EQ(fitted(settings, 1).positions, fitted(settings, 3).positions);
  }
}

/// A factorisation calls between tasks, see SparseCholesky.CallsBetweenSmallTasksAndEndsByAnException. Times are not
/// measured here.
TEST(Fit, AsksOftenWhetherItIsCancelledAndNotAgain) {
  std::vector<int> calls(2, 0);
  const Progress count = [&calls](double, const char* stage) { return ++calls[std::string(stage) == "align"] > 0; };
  fitted({}, 1, count);
  // Before the pairs and before the solution of each round, and between tasks of each stage's factorisation.
  EXPECT_GT(calls[0], 342);
  EXPECT_GT(calls[1], 20);
  for (int at = 1; at < calls[0] + calls[1]; at += 90) {
    int called = 0;
    const Progress stop = [&called, at](double, const char*) { return ++called < at; };
    try {
      fitted({}, 1, stop);
      FAIL() << at;
    } catch (const EditError& error) {
      EXPECT_EQ(error.cause(), ErrorCause::Cancelled);
    }
    EXPECT_EQ(called, at);
  }
}

TEST(SlideOf, FindsWhatTheNormalsDoNotDecide) {
  const Points before = shapes::icosphere(3).vertices, &normals = before;
  const std::vector<char> drawn(static_cast<std::size_t>(before.rows()), 1);
  std::vector<int> samples(drawn.size());
  std::iota(samples.begin(), samples.end(), 0);
  Matrix3 linear = Matrix3::Identity();
  linear(0, 0) = 1.05;
  const Points stretched = before * linear;
  linear << 1, -0.05, 0, 0.05, 1, 0, 0, 0, 1;
  const Points rotated = before * linear;
  EXPECT_LT(slide_of({before, stretched, normals, drawn}, samples, {}).along, 0.005);
  const FitSlide free = slide_of({before, rotated, normals, drawn}, samples, {});
  EXPECT_NEAR(free.along, 0.0393, 0.002);  // 0.05 times pi / 4
  EXPECT_NEAR(free.most, 0.05, 0.002);
  EXPECT_LT(std::abs(before(free.vertex, 2)), 0.2);
  EXPECT_LT(free.across, 1e-4);
  const std::vector<int> corners(samples.begin(), samples.begin() + 12);  // of the icosahedron
  EXPECT_LT(slide_of({before, rotated, normals, drawn}, samples, corners).along, 0.01 * free.along);
  EXPECT_EQ(slide_of({before, rotated, normals, std::vector<char>(drawn.size(), 0)}, samples, {}).vertex, -1);
}

TEST(BestSimilarity, RecoversAMap) {
  const SimilarityMap map = {Eigen::AngleAxisd(2, Vector3(1, 2, 3).normalized()).toRotationMatrix(), 3, {1, 2, 3}};
  const Points points = shapes::head(0.2).vertices;
  const SimilarityMap found = best_similarity(points, map.all(points));
  EXPECT_LT((found.rotation - map.rotation).norm(), 1e-12);
  EXPECT_NEAR(found.scale, 3, 1e-12);
  EXPECT_LT((found.translation - map.translation).norm(), 1e-12);
  EXPECT_EQ(best_similarity(points, map.all(points), 2).scale, 2);
}

TEST(TemplateEnergy, IsZeroForRotatedShapes) {
  const Region region = whole_head();
  TemplateEnergy energy(head(), region, head().vertices, 1.5, 2, std::make_shared<ThreadPool>(1));
  const Matrix3 turn = rotation_about(Vector3(1, 1, 0).normalized(), 50);
  const Points turned = 1.3 * head().vertices * turn.transpose();
  const Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(region.size(), 0.5);
  energy.factor(0.3, diagonal);
  Points right = 0.5 * turned, x;
  energy.add_rotated(std::vector<Matrix3>(static_cast<std::size_t>(region.size()), turn), 1.3, right);
  energy.solve_accurately(right, x);
  EXPECT_LT((x - turned).cwiseAbs().maxCoeff(), 1e-10);
}

}  // namespace
}  // namespace lapedit
