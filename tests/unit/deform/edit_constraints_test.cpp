// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_constraints.h"

#include <gtest/gtest.h>

#include "lapedit/deform/edit_quality.h"
#include "shapes.h"
#include "support.h"

namespace lapedit::edit_constraints_test {
namespace {

const Affine kStay = Affine::Identity();

/// Two spheres: one held at its vertices 0 and 1 and pulled at 100, the other one loose with two groups.
struct Scene {
  TriangleMesh mesh = shapes::two_pieces(2);
  std::shared_ptr<const LaplacianSystem> system =
      prepare_system(mesh, support::rest_pose(mesh, support::whole_region(mesh, {{100}, {200}, {250, 251}}, {0, 1})),
                     EditSettings::of(EditMethod::Paper), {}, nullptr);
  EditConstraints constraints{system->rest};

  Vector3 rest(int i) const { return system->rest.local.row(i).transpose(); }
};

TEST(EditConstraints, NothingMovedIsNothingToDo) {
  Scene s;
  s.constraints.set({kStay, kStay, kStay});
  EXPECT_FALSE(s.constraints.moves_rigidly());
  EXPECT_FALSE(s.constraints.any());
  EXPECT_TRUE(s.constraints.wanted().isZero(0));
}

TEST(EditConstraints, HeldComponentDoesNotMoveRigidly) {
  Scene s;
  const Vector3 way(0.1, 0.2, -0.3);
  s.constraints.set({support::shift(way), kStay, kStay});
  EXPECT_FALSE(s.constraints.moves_rigidly());
  EXPECT_TRUE(s.constraints.any());
  EXPECT_LT((s.constraints.wanted().row(100).transpose() - way).norm(), 1e-12);
  EXPECT_EQ((s.constraints.wanted().array() != 0).count(), 3);
  EXPECT_LT((s.constraints.wanted_displacement(100) - way).norm(), 1e-14);
}

TEST(EditConstraints, LooseComponentGoesByTheRigidMotionThatFitsBest) {
  Scene s;
  const std::vector<int> loose = {200, 250, 251};
  Affine turned = support::rigid(60, Vector3(1, 2, 3), Vector3(4, 5, 6));
  turned.linear() *= 1.6;
  for (const std::vector<HandleMotion>& motions :
       {std::vector<HandleMotion>{kStay, support::shift(Vector3(0.3, 0, 0)), support::shift(Vector3(0, 0.6, 0))},
        std::vector<HandleMotion>{kStay, kStay, turned}, std::vector<HandleMotion>{kStay, turned, kStay}}) {
    s.constraints.set(motions);
    EXPECT_TRUE(s.constraints.moves_rigidly());
    EXPECT_EQ(s.constraints.rigid_motion(100).displacement(s.rest(100)), Vector3(0, 0, 0));
    const Matrix3 rotation = s.constraints.rigid_motion(200).linear + Matrix3::Identity();
    EXPECT_LT(support::rotation_defect(rotation), 1e-12);
    EXPECT_LT((s.constraints.rigid_rotation(200) - rotation).norm(), 1e-12);
    Vector3 centre = Vector3::Zero(), goal = centre;
    for (const int i : loose) {
      centre += s.rest(i) / 3;
      goal += (s.rest(i) + s.constraints.wanted_displacement(i)) / 3;
    }
    EXPECT_LT((centre + s.constraints.rigid_motion(200).displacement(centre) - goal).norm(), 1e-13);
    const auto error = [&](const Matrix3& candidate) {
      double sum = 0;
      for (const int i : loose) {
        sum +=
            (candidate * (s.rest(i) - centre) + goal - s.rest(i) - s.constraints.wanted_displacement(i)).squaredNorm();
      }
      return sum;
    };
    for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(1, 1, 1)}) {
      for (const double degrees : {-5.0, 5.0}) {
        EXPECT_LE(error(rotation), error(support::rigid(degrees, axis, Vector3::Zero()).linear() * rotation) + 1e-12);
      }
    }
  }
}

/// A map that all groups have is taken to the bit, even one that shears.
TEST(EditConstraints, ComponentFollowsGroupsThatAgreeExactly) {
  Scene s;
  Affine map = support::rigid(70, Vector3(1, 2, 3), Vector3(4, 5, 6));
  map.linear()(0, 1) += 0.3;
  s.constraints.set({kStay, map, map});
  EXPECT_EQ(s.constraints.rigid_motion(200).linear, Matrix3(map.linear() - Matrix3::Identity()));
  EXPECT_TRUE(s.constraints.wanted().isZero(0));
}

TEST(MeasureEdit, IsMeasuredFromTheTargets) {
  Scene s;
  const Affine away = support::shift(Vector3(2, 0, 0));
  s.constraints.set({support::shift(Vector3(0, 0, 0.5)), away, away});
  const int n = s.system->region.size();
  Points d = Points::Zero(n, 3);
  d.row(100) << 0, 0, 0.4;
  d.row(1) << 0.03, 0, 0.04;
  std::vector<Matrix3> rotations(n, Matrix3::Identity());
  rotations[7] = support::rigid(30, Vector3(1, 0, 1), Vector3::Zero()).linear();
  rotations[8] = support::rigid(-60, Vector3::UnitZ(), Vector3::Zero()).linear();
  Points positions = s.mesh.vertices + d;
  for (int i = 0; i < n; ++i) {
    positions.row(i) += s.constraints.rigid_motion(i).displacement(s.system->rest.local.row(i).transpose()).transpose();
  }
  EditReport found;
  measure_edit(*s.system, s.constraints, positions, rotations, found);
  EXPECT_NEAR(found.handle_displacement, 2, 1e-14);
  EXPECT_NEAR(found.handle_residual, 0.1, 1e-14) << "the rigid motion has arrived";
  EXPECT_NEAR(found.anchor_residual, 0.05, 1e-14);
  EXPECT_NEAR(found.rotation_max, 60, 1e-12);
  EXPECT_GT(found.stretch_rms, 0);
  EXPECT_EQ(found.stretch_rms, edge_stretch(s.system->region, s.mesh.vertices, positions).rms);
  EXPECT_EQ(found.flipped, 0);
}

}  // namespace
}  // namespace lapedit::edit_constraints_test
