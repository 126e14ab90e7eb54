// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/motion_path.h"

#include <gtest/gtest.h>

#include "support.h"

namespace lapedit {
namespace {

using support::rigid;
using support::shift;

const Vector3 kCentre(1, -2, 0.5);
const std::vector<Vector3> kPlaces = {kCentre, Vector3(2, -2, 0.5), Vector3(0.3, -1, 1.5), Vector3(1, -4, -2)};
const std::vector<double> kParts = {0, 0.1, 1.0 / 3, 0.5, 0.9, 0.999, 1};

LocalMotion motion(const Affine& map) {
  return LocalMotion::of(map, Vector3::Zero());
}

MotionPath path_of(const Affine& target) {
  return {LocalMotion(), motion(target), kCentre};
}

Vector3 place_after(const MotionPath& path, const Vector3& rest, double part, const LocalMotion& carried = {}) {
  return rest + carried.displacement(rest) + path.way(rest, part);
}

std::vector<Affine> some_maps() {
  Affine shear = rigid(70, Vector3(1, 0, 2), Vector3(0.3, 0, 1), kCentre);
  shear.linear() *= (Matrix3() << 1.5, 0.4, 0, 0, 0.7, 0, 0.2, 0, 1).finished();
  return {Affine::Identity(),
          shift(Vector3(1, 2, 3)),
          rigid(29, Vector3(1, 2, 3), Vector3(1, 0, 0)),
          rigid(140, Vector3(1, 2, 3), Vector3(1, 0, 0), kCentre),
          rigid(180, Vector3(0, 0, 1), Vector3(0, 0, 4)),
          Affine(Eigen::Scaling(2.5)),
          Affine(Eigen::Scaling(Vector3(1, 1, -1))),
          shear};
}

/// Fails if a path ends beside its target by rounding, or does not begin where things are.
TEST(MotionPath, LeadsFromNoWayToTheTargetToTheBit) {
  for (const Affine& carried : some_maps()) {
    for (const Affine& target : some_maps()) {
      const MotionPath path(motion(carried), motion(target), kCentre);
      for (const Vector3& rest : kPlaces) {
        EXPECT_EQ(path.way(rest, 1), motion(target).displacement(rest) - motion(carried).displacement(rest));
        EXPECT_LT(path.way(rest, 0).norm(), 1e-13);
        EXPECT_LT((path.way(rest, 1 - 1e-9) - path.way(rest, 1)).norm(), 1e-7) << "a jump at the end";
        for (const double part : kParts) {
          EXPECT_TRUE(path.way(rest, part).allFinite());
        }
      }
    }
  }
}

/// Fails if a group takes the chord, on which it would shrink or come too near.
TEST(MotionPath, TurnAboutAFarPivotKeepsTheDistanceFromIt) {
  const Vector3 pivot(40, 3, -7);
  for (const double degrees : {31.0, 90.0, 150.0, 179.0, 180.0}) {
    const MotionPath path = path_of(rigid(degrees, Vector3(0.2, 1, 0.4), Vector3::Zero(), pivot));
    for (const Vector3& rest : kPlaces) {
      for (const double part : kParts) {
        EXPECT_NEAR((place_after(path, rest, part) - pivot).norm(), (rest - pivot).norm(), 1e-11) << degrees;
      }
    }
  }
}

TEST(MotionPath, StaysRigidWhereTheTargetIs) {
  for (const double degrees : {5.0, 29.0, 31.0, 120.0, 179.9, 180.0}) {
    const MotionPath path = path_of(rigid(degrees, Vector3(1, 2, -1), Vector3(3, 0, 1), Vector3(0, 5, 0)));
    for (const double part : kParts) {
      for (const Vector3& a : kPlaces) {
        for (const Vector3& b : kPlaces) {
          EXPECT_NEAR((place_after(path, a, part) - place_after(path, b, part)).norm(), (a - b).norm(), 1e-12);
        }
      }
    }
  }
}

/// Each part turns further about the same axis, the whole way in steps() parts of not much more than 30 degrees.
TEST(MotionPath, TurnsEvenlyEnoughAndAlongItsAxis) {
  const Vector3 axis(0, 0, 1);
  for (const double degrees : {45.0, 90.0, 135.0, 180.0}) {
    const MotionPath path = path_of(rigid(degrees, axis, Vector3(0, 0, 2), kCentre));
    Vector3 before = Vector3::UnitX();
    for (int step = 1; step <= path.steps(); ++step) {
      const double part = static_cast<double>(step) / path.steps();
      const Vector3 now = place_after(path, kCentre + Vector3::UnitX(), part) - place_after(path, kCentre, part);
      const double angle = std::atan2(before.cross(now)[2], before.dot(now)) * 180 / std::acos(-1.0);
      EXPECT_GT(angle, 10) << degrees << ", step " << step;
      EXPECT_LT(angle, 50) << degrees << ", step " << step;
      EXPECT_NEAR(path.way(kCentre, part)[2], 2 * part, 1e-12);
      before = now;
    }
  }
}

TEST(MotionPath, TakesAStepForEach30Degrees) {
  const Vector3 axis(1, 2, 3);
  for (const auto& [degrees, steps] : {std::pair(0.0, 1),
                                       {1.0, 1},
                                       {29.0, 1},
                                       {31.0, 2},
                                       {59.0, 2},
                                       {61.0, 3},
                                       {89.0, 3},
                                       {91.0, 4},
                                       {119.0, 4},
                                       {121.0, 5},
                                       {149.0, 5},
                                       {151.0, 6},
                                       {179.0, 6},
                                       {180.0, 6},
                                       {181.0, 6},
                                       {-31.0, 2},
                                       {330.5, 1},
                                       {359.0, 1}}) {
    EXPECT_EQ(path_of(rigid(degrees, axis, Vector3(1, 0, 0), Vector3(4, 5, 6))).steps(), steps) << degrees;
  }
  for (const Vector3& other : {axis, Vector3(0, 0, 1), Vector3(1, -1, 0.3)}) {
    for (int thirty = 1; thirty <= 6; ++thirty) {
      EXPECT_EQ(path_of(rigid(30 * thirty, other, Vector3::Zero())).steps(), thirty) << "rounding must not decide";
    }
  }
  EXPECT_EQ(path_of(shift(Vector3(100, 0, 0))).steps(), 1);
  EXPECT_EQ(path_of(Affine(Eigen::Scaling(7.0))).steps(), 1) << "no turn";
}

TEST(MotionPath, ScaleAndShearFadeIn) {
  const Vector3 way(0.5, 1, -2);
  Affine scaled = shift(kCentre + way) * Eigen::Scaling(3.0) * shift(-kCentre);
  const MotionPath growing = path_of(scaled);
  for (const Vector3& rest : kPlaces) {
    for (const double part : kParts) {
      const Vector3 expected = part * (2 * (rest - kCentre) + way);
      EXPECT_LT((growing.way(rest, part) - expected).norm(), 1e-13);
    }
  }
  // Behind a turn the stretch is what it is without one.
  Matrix3 stretch;
  stretch << 1.4, 0.3, 0, 0.3, 0.9, 0.1, 0, 0.1, 1.1;
  Affine both = rigid(100, Vector3(1, 1, 0), Vector3(2, 0, 0), kCentre);
  both.linear() *= stretch;
  both.translation() = kCentre + Vector3(2, 0, 0) - both.linear() * kCentre;
  const MotionPath path = path_of(both);
  for (const double part : {0.25, 0.5, 0.75}) {
    const Matrix3 expected = Matrix3::Identity() + part * (stretch - Matrix3::Identity());
    const Vector3 middle = place_after(path, kCentre, part);
    for (const Vector3& rest : kPlaces) {
      EXPECT_NEAR((place_after(path, rest, part) - middle).norm(), (expected * (rest - kCentre)).norm(), 1e-12);
    }
  }
}

/// A singular map has no inverse to be relative to.
TEST(MotionPath, SingularMapsGiveFiniteWays) {
  Affine flat = rigid(50, Vector3(1, 0, 0), Vector3(0, 1, 0)), point = shift(Vector3(1, 1, 1));
  flat.linear() *= Vector3(1, 1, 0).asDiagonal();
  point.linear().setZero();
  for (const Affine& singular : {flat, point}) {
    for (const Affine& other : some_maps()) {
      for (const MotionPath& path :
           {MotionPath(motion(singular), motion(other), kCentre), MotionPath(motion(other), motion(singular), kCentre),
            MotionPath(motion(singular), motion(singular), kCentre)}) {
        EXPECT_GE(path.steps(), 1);
        for (const double part : kParts) {
          EXPECT_TRUE(path.way(kPlaces[1], part).allFinite()) << part;
        }
      }
    }
    const MotionPath path(motion(singular), motion(some_maps()[3]), kCentre);
    EXPECT_EQ(path.way(kPlaces[1], 1),
              motion(some_maps()[3]).displacement(kPlaces[1]) - motion(singular).displacement(kPlaces[1]));
  }
}

/// What is carried and then turned goes the way of what lies there from the start.
TEST(MotionPath, IsRelativeToWhereTheComponentIsCarried) {
  const Affine carried = rigid(110, Vector3(0, 1, 1), Vector3(5, 0, 0)), further = some_maps()[3];
  const MotionPath path(motion(carried), motion(Affine(further * carried)), kCentre);
  const MotionPath there(LocalMotion(), motion(further), carried * kCentre);
  EXPECT_EQ(path.steps(), there.steps());
  const MotionPath none(motion(carried), motion(carried), kCentre);
  EXPECT_EQ(none.steps(), 1);
  for (const Vector3& rest : kPlaces) {
    for (const double part : kParts) {
      EXPECT_LT((path.way(rest, part) - there.way(carried * rest, part)).norm(), 1e-12);
      EXPECT_LT(none.way(rest, part).norm(), 1e-14);
    }
  }
}

}  // namespace
}  // namespace lapedit
