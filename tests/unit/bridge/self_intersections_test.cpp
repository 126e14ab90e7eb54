// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/edit/self_intersections.h"

#include <gtest/gtest.h>
#include <vcg/complex/algorithms/clean.h>

#include <limits>
#include <numeric>
#include <set>

#include "host_support.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::self_intersections_test {
namespace {

/// The pairs that vcglib finds among all.
std::vector<char> meeting(const TriangleMesh& mesh) {
  CMeshO model;
  host::fill(model, mesh);
  using Clean = vcg::tri::Clean<CMeshO>;
  std::vector<char> found;
  for (std::size_t i = 0; i < model.face.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      found.push_back(Clean::TestFaceFaceIntersection(&model.face[j], &model.face[i]) ||
                      Clean::TestFaceFaceIntersection(&model.face[i], &model.face[j]));
    }
  }
  return found;
}

int counted_by_vcglib(const TriangleMesh& mesh, const EditResult& result) {
  const std::vector<char> before = meeting(mesh), now = meeting({support::edited(mesh, result), mesh.faces});
  int count = 0;
  for (std::size_t k = 0; k < now.size(); ++k) count += now[k] && !before[k];
  return count;
}

/// A limb whose tip is pulled by some way.
EditResult pulled(const TriangleMesh& mesh, const Vector3& way) {
  EditStep step;
  step.settings = EditSettings::of(EditMethod::Linear);  // which lets it fold
  step.region.radius = 7;
  step.handles = {{{static_cast<int>(mesh.vertices.rows()) - 1}, {}}};
  step.handles[0].transform.translation = way;
  return support::apply_step(mesh, step, 1, StoredScalar::Float);
}

TEST(SelfIntersections, OfALimbPulledThroughItselfAreThoseOfVcglib) {
  const TriangleMesh mesh = shapes::tapered_arm(16, 40);
  for (const Vector3& way : {Vector3(-5, 0, 0.5), Vector3(-8, 0.1, 0), Vector3(-9, 0, -3)}) {
    const EditResult result = pulled(mesh, way);
    const int found = new_self_intersections(mesh, result);
    EXPECT_GT(found, 5);
    const int pairs = counted_by_vcglib(mesh, result);  // in single precision, which decides some otherwise
    EXPECT_NEAR(found, pairs, 0.04 * pairs);
    EXPECT_EQ(found, new_self_intersections(mesh, result, 1)) << "on one thread";
    for (const double size : {0x1p-20, 0x1p20}) {
      EditResult scaled = result;
      scaled.positions *= size;
      EXPECT_EQ(found, new_self_intersections({size * mesh.vertices, mesh.faces}, scaled)) << size;
    }
  }
}

TEST(SelfIntersections, AreNoneWhereNothingMeets) {
  const TriangleMesh mesh = shapes::tapered_arm(16, 40);
  EXPECT_EQ(new_self_intersections(mesh, pulled(mesh, Vector3(0, 0, 2))), 0);
  EXPECT_EQ(new_self_intersections(mesh, pulled(mesh, Vector3(0, 0, 0))), 0);
  EXPECT_EQ(new_self_intersections(mesh, {}), 0);
}

/// A moved piece meets one that stayed; what met before is not new; neither place nor size matters.
TEST(SelfIntersections, OfPiecesAreThoseThatAreNew) {
  const TriangleMesh ball = shapes::icosphere(2);
  const int n = static_cast<int>(ball.vertices.rows());
  std::set<int> everywhere;
  for (const double size : {1e-8, 1.0, 1e8}) {
    for (const double position : {0.0, 1e3}) {
      const auto moved_by = [&](double from, double to) {
        TriangleMesh both = shapes::together(ball, ball, Vector3(from, 0.011, 0.007));
        EditResult result;
        result.vertices.resize(n);
        std::iota(result.vertices.begin(), result.vertices.end(), n);
        both.vertices = (size * both.vertices).rowwise() + size * position * Vector3::Ones().transpose();
        result.positions = both.vertices.bottomRows(n).rowwise() + size * Vector3(to - from, 0, 0).transpose();
        const int found = new_self_intersections(both, result);
        if (size == 1.0 && position == 0) {
          EXPECT_EQ(found, counted_by_vcglib(both, result));
        }
        return found;
      };
      const int met = moved_by(3, 1.5);
      EXPECT_GT(met, 20);
      everywhere.insert(met);
      EXPECT_EQ(moved_by(1.5, 3), 0) << "they part";
      EXPECT_EQ(moved_by(3, 2.5), 0);
      EXPECT_LT(moved_by(1.5, 1.5001), met / 4) << "most of them met before";
    }
  }
  EXPECT_EQ(everywhere.size(), 1U);
}

TEST(SelfIntersections, OfFacesThatAreNoneAreNone) {
  for (TriangleMesh mesh : {shapes::degenerate_grid(12, 12), shapes::non_manifold_grid(12, 12)}) {
    EditResult result;
    result.vertices = {70, 71};
    result.positions = support::rows(mesh.vertices, result.vertices).rowwise() + Vector3(0, 0, 0.25).transpose();
    EXPECT_EQ(new_self_intersections(mesh, result), counted_by_vcglib(mesh, result));
    mesh.vertices.row(0).setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_GE(new_self_intersections(mesh, result), 0);
  }
}

TEST(SelfIntersections, AreLeftOutOfAReportWhereThereAreTooManyVertices) {
  const TriangleMesh mesh = shapes::tapered_arm(16, 40);
  EditResult result = pulled(mesh, Vector3(-5, 0, 0.5));
  const int size = static_cast<int>(result.vertices.size());
  count_self_intersections(mesh, result, size - 1);
  EXPECT_FALSE(result.reports[0].new_intersections);
  count_self_intersections(mesh, result, size);
  EXPECT_EQ(result.reports[0].new_intersections, new_self_intersections(mesh, result));
}

}  // namespace
}  // namespace lapedit::self_intersections_test
