// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/step_solver.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <vector>

#include "lapedit/deform/laplacian_system.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::step_solver_test {
namespace {

using support::Prepared;
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

/// Fails if an edge is rotated by another mean, or a term is missing: the derivative of the energies of bending,
/// stretching and constraints by the pose, given its rotations. tests/cli/edits_test.py has the other methods.
TEST(StepSolver, PoseIsTheMinimumGivenItsRotations) {
  const TriangleMesh mesh = wavy_letters(17, 10);
  const std::vector<HandleMotion> maps{support::rigid(35, Vector3(1, 0, 1), Vector3(0.1, 0, 0.4), Vector3(1.8, 1, 0)),
                                       support::shift(Vector3(-0.1, 0.2, 0.3))};
  const Region region = support::region_of(mesh, within(1.3), {{74, 75, 84}, {112}});
  const Points rest = support::rows(mesh.vertices, region.mesh_vertex);
  for (const LaplacianKind laplacian : {LaplacianKind::Umbrella, LaplacianKind::Cotangent, LaplacianKind::MeanValue}) {
    for (const auto& [iterations, membrane] : {std::pair(1, 1200.0), {3, 0.0}, {3, 500.0}}) {
      EditSettings settings;
      settings.laplacian = laplacian;
      settings.iterations = iterations;
      settings.membrane = membrane;
      Prepared solver(mesh, region, settings);
      const Points& pose = solver.pose(maps);
      const DifferentialOperator op = differential_operator(laplacian, region, mesh, membrane > 0);
      const Eigen::MatrixXd m = op.matrix;
      Points bent = m * pose;
      for (int i = 0; i < region.size(); ++i) {
        for (int j = 0; j < region.size(); ++j) {
          const Matrix3 mean = (solver.rotations()[i] + solver.rotations()[j]) / 2;
          bent.row(i) += m(i, j) * (mean * Vector3(rest.row(i) - rest.row(j))).transpose();
        }
      }
      Eigen::MatrixXd left = m.transpose();
      left.diagonal() += membrane_factor(membrane, region, rest, op.mean) * op.divisor;
      Points derivative = left * bent;
      Eigen::MatrixXd second = left * m;
      for (int i = 0; i < region.size(); ++i) {
        const bool handle = region.group[i] >= 0;
        const double weight = handle ? settings.handle_weight : settings.anchor_weight * region.anchor_weight[i];
        const Vector3 at = rest.row(i).transpose(), target = handle ? maps[region.group[i]].map * at : at;
        derivative.row(i) += weight * weight * (pose.row(i) - target.transpose());
        second(i, i) += weight * weight;
      }
      EXPECT_LT(second.ldlt().solve(derivative).norm(), 1e-9 * pose.norm()) << name(laplacian) << ", " << membrane;
    }
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

/// A disc of a CAD program at the end of a tube. Its middle has the square of its neighbours in the matrix of order 2.
TEST(Conditioning, FanTakesMemoryOfItsSizeOrIsRefused) {
  constexpr int kAround = 4000;
  TriangleMesh mesh = shapes::cylinder(kAround, 3);  // its first vertex is the middle of a disc, and its last one
  mesh.vertices.col(0) *= 0.05;
  std::vector<int> boundary(kAround + 1);
  std::iota(boundary.begin(), boundary.end(), 2 * kAround + 1);
  const Region region = support::whole_region(mesh, {{7}}, boundary);
  for (const EditMethod method : {EditMethod::Default, EditMethod::Linear}) {
    const auto system = Prepared(mesh, region, EditSettings::of(method)).system();
    EXPECT_EQ(system->matrix->long_rows.size(), 2U);
    EXPECT_LT(system->matrix->cholesky.factor_nonzeros(), 100U * mesh.vertices.rows()) << name(method);
  }
  EditSettings second = EditSettings::of(EditMethod::Linear);
  second.order = 2;
  const std::string refusal =
      support::expect_refusal(ErrorCause::BadParameter, [&] { Prepared(mesh, region, second); });
  support::expect_contains(refusal, "Vertex 0 has 4000 neighbours");
}

}  // namespace
}  // namespace lapedit::step_solver_test
