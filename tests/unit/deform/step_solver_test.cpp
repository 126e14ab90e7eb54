// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_solver.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "dense_reference.h"
#include "lapedit/deform/laplacian_system.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::step_solver_test {
namespace {

using support::Prepared;
using support::vertices_where;
using support::within;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Raised letters on gentle waves: no two edges of a vertex are equally tangential.
TriangleMesh wavy_letters(int nx, int ny) {
  TriangleMesh mesh = shapes::letter_field(nx, ny);
  for (auto p : mesh.vertices.rowwise()) {
    p[2] += 0.1 * std::sin(3 * p[0] + 0.4) * std::cos(2.3 * p[1]);
  }
  return mesh;
}

/// Small problems with everything in them: an irregular mesh that goes on outside the region, two handle groups.
struct SmallProblem {
  TriangleMesh mesh = wavy_letters(17, 10);
  std::vector<std::vector<int>> handles{{74, 75, 84}, {112}};
  std::vector<HandleMotion> maps{support::rigid(35, Vector3(1, 0, 1), Vector3(0.1, 0, 0.4), Vector3(1.8, 1, 0)),
                                 support::shift(Vector3(-0.1, 0.2, 0.3))};
  Region region = support::region_of(mesh, within(1.3), handles);
  Points rest = support::rows(mesh.vertices, region.mesh_vertex);
  Points targets = rest;

  SmallProblem() {
    for (int i = 0; i < region.size(); ++i) {
      if (region.group[i] >= 0) {
        targets.row(i) = (maps[region.group[i]].map * Vector3(rest.row(i))).transpose();
      }
    }
  }
};

const std::vector<EditSettings> kDenseSettings = [] {
  std::vector<EditSettings> all;
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent}) {
    for (const int order : {1, 2, 3}) {
      for (const double weight : {1.0, 10.0}) {
        EditSettings settings = EditSettings::of(EditMethod::Paper);
        settings.laplacian = laplacian;
        settings.order = order;
        settings.handle_weight = weight;
        settings.anchor_weight = 2 * weight;
        settings.normal_radius = 0.8;
        all.push_back(settings);
      }
    }
  }
  return all;
}();

/// The same, and the other methods with several operators and membranes.
const std::vector<EditSettings> kGivenRotations = [] {
  std::vector<EditSettings> all = kDenseSettings;
  for (const int iterations : {1, 3}) {
    for (const LaplacianKind laplacian :
         {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
      EditSettings& settings = all.emplace_back();
      settings.laplacian = laplacian;
      settings.iterations = iterations;
      settings.membrane = laplacian == LaplacianKind::MeanValue ? settings.membrane : iterations == 1 ? 1200 : 0;
    }
  }
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
    for (const double membrane : {0.0, 60.0}) {
      EditSettings& settings = all.emplace_back(EditSettings::of(EditMethod::Paper));
      settings.laplacian = laplacian;
      settings.membrane = membrane;
      settings.normal_radius = 0.8;
    }
  }
  return all;
}();

std::string describe(const EditSettings& settings) {
  return std::string(name(settings.method)) + ", " + name(settings.laplacian) + ", order " +
         std::to_string(settings.order) + ", weight " + std::to_string(settings.handle_weight);
}

TEST(DenseLeastSquares, AgreesWithTheUnrotatedEdit) {
  const SmallProblem problem;
  ASSERT_GT(problem.region.size(), 80);
  ASSERT_LT(problem.region.size(), 165) << "some of the mesh has to lie outside";
  const std::vector<Matrix3> unrotated(problem.region.size(), Matrix3::Identity());
  for (EditSettings settings : kDenseSettings) {
    settings.method = EditMethod::Linear;
    settings.normal_radius = 0;
    Prepared solver(problem.mesh, problem.region, settings);
    const Points expected = reference::solve(problem.mesh, problem.region, settings, problem.targets, unrotated);
    EXPECT_LT(support::error(solver.pose(problem.maps), expected), 1e-9) << describe(settings);
    EXPECT_EQ(solver.rotations(), unrotated);
  }
}

TEST(DenseLeastSquares, AgreesWithTheRotatedEditGivenItsRotations) {
  const SmallProblem problem;
  for (const EditSettings& settings : kGivenRotations) {
    Prepared solver(problem.mesh, problem.region, settings);
    const Points& found = solver.pose(problem.maps);
    const Points expected =
        reference::solve(problem.mesh, problem.region, settings, problem.targets, solver.rotations());
    EXPECT_LT(support::error(found, expected), 1e-9) << describe(settings);
  }
}

/// All four steps of the paper, without a line of the core but the region.
TEST(DenseLeastSquares, AgreesWithThePapersMethod) {
  SmallProblem problem;
  problem.region.anchor_depth.clear();
  const std::vector<Matrix3> unrotated(problem.region.size(), Matrix3::Identity());
  for (const EditSettings& settings : kDenseSettings) {
    const Points rough = reference::solve(problem.mesh, problem.region, settings, problem.targets, unrotated);
    const std::vector<Matrix3> rotations =
        reference::paper_rotations(problem.region, problem.rest, rough, settings.normal_radius);
    const Points expected = reference::solve(problem.mesh, problem.region, settings, problem.targets, rotations);
    Prepared solver(problem.mesh, problem.region, settings);
    EXPECT_LT(support::error(solver.pose(problem.maps), expected), 1e-9) << describe(settings);
    EXPECT_LT(support::largest_angle(solver.rotations(), rotations), 1e-8) << describe(settings);
    EXPECT_GT(support::largest_angle(rotations, unrotated), 0.2) << "the edit has to rotate something";
  }
}

/// Normal equations square the condition number, which a QR factorisation does not: iterative refinement has to make up
/// for it. Without it the errors are 5e-9 and 7e-6 here.
TEST(DenseLeastSquares, AgreesWhereTheNormalEquationsAreIllConditioned) {
  const TriangleMesh mesh = shapes::bar(40, 1, 1);
  const std::vector<int> held = vertices_where(mesh, [](const Vector3& p) { return p[0] <= 1; });
  const std::vector<int> pulled = vertices_where(mesh, [](const Vector3& p) { return p[0] == 40; });
  const Region region = support::whole_region(mesh, {pulled}, held);
  const Affine map = support::shift(Vector3(0, 0, 5));
  Points targets = mesh.vertices;
  for (const int v : pulled) {
    targets(v, 2) += 5;
  }
  for (const auto& [order, bound] : {std::pair{2, 1e-11}, std::pair{3, 1e-8}}) {
    EditSettings settings = EditSettings::of(EditMethod::Linear);
    settings.order = order;
    Prepared solver(mesh, region, settings);
    const std::vector<Matrix3> unrotated(region.size(), Matrix3::Identity());
    const Points expected = reference::solve(mesh, region, settings, targets, unrotated);
    EXPECT_LT(support::error(solver.pose({map}), expected), bound) << "order " << order;
  }
}

class SolverErrors : public ::testing::Test {
 protected:
  TriangleMesh mesh = wavy_letters(20, 12);
  Region region = support::region_of(mesh, within(0.8), {{120}, {124}});
};

TEST_F(SolverErrors, SettingsAreChecked) {
  EditSettings settings;
  settings.order = 7;
  support::expect_refusal(ErrorCause::BadParameter, [&] { Prepared(mesh, region, settings); });
}

/// Fails if a pose beyond all numbers leaves something behind, also where it is the first one.
TEST_F(SolverErrors, StaysUsableAfterARefusedSolve) {
  Prepared solver(mesh, region, {});
  const std::vector<HandleMotion> good = {support::shift(Vector3(0, 0, 0.3)), support::shift(Vector3(0, 0, 0.2))};
  const Points expected = Prepared(mesh, region, {}).pose(good);
  Affine bad = Affine::Identity();
  bad(1, 3) = kNaN;
  const Affine far = support::shift(Vector3(1e308, 1e308, 1e308));
  support::expect_refusal(ErrorCause::NotFinite, [&] { solver.pose({far, good[1]}); });
  EXPECT_TRUE(support::same_bits(solver.pose(good), expected));
  support::expect_refusal(ErrorCause::NoHandle, [&] { solver.pose({good[0]}); });
  support::expect_refusal(ErrorCause::NotFinite, [&] { solver.pose({good[0], bad}); });
  bad(1, 3) = kInfinity;
  support::expect_refusal(ErrorCause::NotFinite, [&] { solver.pose({bad, good[1]}); });
  support::expect_refusal(ErrorCause::NotFinite, [&] { solver.pose({far, good[1]}); });
  EXPECT_TRUE(support::same_bits(solver.pose(good), expected));
}

/// Fails if a pose that was ended in the middle leaves something that a later one takes for its own. The whole mesh
/// moves, so each pose starts from another place.
TEST(StepSolver, CancelledPosesLeaveNoTrace) {
  const TriangleMesh mesh = wavy_letters(40, 24);
  const Region region = support::whole_region(mesh, {{400}, {480}}, {});
  const std::vector<HandleMotion> good = {support::shift(Vector3(0, 0, 0.3)), support::shift(Vector3(0, 0, 0.2))};
  const std::vector<HandleMotion> other = {support::shift(Vector3(1, 0, 0.3)), support::shift(Vector3(0, 1, 0.2))};
  for (const EditMethod method : {EditMethod::Default, EditMethod::Paper, EditMethod::Linear}) {
    Prepared solver(mesh, region, EditSettings::of(method), {StoredScalar::Double, {}, {1}});
    const Points expected = solver.pose(good);
    int stopped = 0;
    for (bool is_done = false; !is_done; stopped += stopped < 20 ? 1 : 11) {
      for (const std::vector<HandleMotion>* motions : {&other, &good}) {
        int calls = 0;
        const Progress until = [&](double, const char*) { return calls++ < stopped; };
        const ProgressScope scope(until);
        try {
          solver.pose(*motions);
          is_done = true;
        } catch (const EditError& error) {
          ASSERT_EQ(error.cause(), ErrorCause::Cancelled);
        }
      }
      ASSERT_TRUE(support::same_bits(solver.pose(good), expected)) << name(method) << ", call " << stopped;
    }
    EXPECT_GT(stopped, 5) << name(method);
  }
}

/// A mesh that is held in one vertex.
struct HeldInAVertex {
  TriangleMesh mesh = shapes::grid(60, 60);
  Region region = support::whole_region(mesh, {{30 * 60 + 30}}, {});
  EditSettings settings = EditSettings::of(EditMethod::Paper);
};

/// Of order 3 the smallest eigenvalue is about 1e-19 of the largest.
TEST(Conditioning, SystemBeyondDoublePrecisionIsRefusedNotSolvedWrongly) {
  HeldInAVertex held;
  held.settings.order = 3;
  const std::string sentence =
      support::expect_refusal(ErrorCause::IllConditioned, [&] { Prepared(held.mesh, held.region, held.settings); });
  support::expect_contains(sentence, "3600 region vertices");
  support::expect_contains(sentence, ": use a lower order");
}

TEST(Conditioning, RefusedMatrixBecomesAdvice) {
  const Region region = support::whole_region(shapes::grid(4, 5), {{0}}, {});
  SparseMatrix matrix(2, 2);
  matrix.insert(0, 0) = 1;
  matrix.insert(1, 1) = -1;
  matrix.makeCompressed();
  const std::string sentence = support::expect_refusal(ErrorCause::IllConditioned,
                                                       [&] { factorise_for(region, [&] { SparseCholesky{matrix}; }); });
  EXPECT_NE(sentence.find("The system of 20 region vertices is singular to working precision: use "), std::string::npos)
      << sentence;
  support::expect_refusal(ErrorCause::Cancelled, [&] {
    factorise_for(region, [] { throw EditError(ErrorCause::Cancelled, "The edit was cancelled."); });
  });
}

/// Refused before the factor is made, but not where a membrane holds the region: fails if the estimate knows of bending
/// alone.
TEST(Conditioning, HopelessRegionsAreRefusedUnlessAMembraneHoldsThem) {
  const TriangleMesh mesh = shapes::grid(150, 150);
  const Region region = support::region_of(mesh, within(100), {{75 * 150 + 75}});
  EditSettings settings = EditSettings::of(EditMethod::Linear);
  settings.order = 3;
  support::expect_refusal(ErrorCause::IllConditioned, [&] { Prepared(mesh, region, settings); });
  settings.membrane = 50000;  // far from where it is chance
  Prepared solver(mesh, region, settings);
  solver.pose({support::shift(Vector3(1, 2, 3))});
  EXPECT_LT(solver.report().handle_residual, 1e-6);
}

TEST(Conditioning, RefusalOfOrderOneAdvisesNoLowerOne) {
  HeldInAVertex held;
  held.settings.handle_weight = 2e-6;
  support::expect_contains(
      support::expect_refusal(ErrorCause::IllConditioned, [&] { Prepared(held.mesh, held.region, held.settings); }),
      "use a smaller region or larger weights.");
  held.settings.handle_weight = 1e-5;
  Prepared(held.mesh, held.region, held.settings);
}

}  // namespace
}  // namespace lapedit::step_solver_test
