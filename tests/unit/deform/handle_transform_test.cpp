// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/handle_transform.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "support.h"

namespace lapedit::handle_transform_test {
namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-14;  // a few units in the last digit of numbers around 10
const Vector3 kCentre(1, -2, 0.5);

Matrix3 rotation_matrix(double degrees, const Vector3& axis) {
  return Eigen::AngleAxisd(degrees * kPi / 180, axis.normalized()).toRotationMatrix();
}

HandleTransform rotation(double degrees, const Vector3& axis) {
  HandleTransform transform;
  transform.degrees = degrees;
  transform.axis = axis;
  return transform;
}

TEST(HandleTransform, TargetOfAMatrixTranslationOrScaleIsExact) {
  HandleTransform transform;
  transform.matrix = Matrix34::Random();
  transform.matrix->col(3) << 0.1, 1e9, -1e-9;
  EXPECT_EQ(resolve(transform, kCentre).map.matrix(), *transform.matrix);
  transform.matrix.reset();
  transform.translation = {0.1, -1e-9, 1e9};
  EXPECT_EQ(resolve(transform, kCentre).map.translation(), transform.translation);
  for (const double scale : {0.1, 0.7, 1.1, 3.3, 1e-9, 1e9}) {
    transform.scale = scale;
    EXPECT_EQ(resolve(transform, kCentre).map.linear(), scale * Matrix3::Identity());
  }
}

TEST(HandleTransform, RotatesAndScalesAboutTheCenterThenTranslates) {
  HandleTransform transform = rotation(50, {1, 2, -1});
  transform.scale = 1.5;
  transform.translation = {3, 4, 5};
  const Vector3 point(-1, 2, 7);
  const auto expected = [&](const Vector3& center) {
    return Vector3(center + 1.5 * rotation_matrix(50, {1, 2, -1}) * (point - center) + transform.translation);
  };
  EXPECT_LT((resolve(transform, kCentre).map * point - expected(kCentre)).norm(), kRounding);
  transform.center = Vector3(10, 0, -3);
  EXPECT_LT((resolve(transform, kCentre).map * point - expected({10, 0, -3})).norm(), 4 * kRounding);
}

TEST(HandleTransform, LengthOfTheAxisDoesNotMatter) {
  const Matrix3 expected = rotation_matrix(40, {1, 2, 2});
  for (const double length : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
    EXPECT_LT((resolve(rotation(40, length * Vector3(1, 2, 2)), kCentre).map.linear() - expected).norm(), kRounding)
        << length;
  }
}

/// A map does not know its number of revolutions.
TEST(HandleTransform, KeepsAxisAndRevolutions) {
  HandleTransform transform = rotation(-400, {0, 3, 4});
  transform.center = Vector3(1, 1, 1);
  const HandleMotion motion = resolve(transform, kCentre);
  ASSERT_TRUE(motion.rotation);
  EXPECT_EQ(motion.rotation->degrees, -400);
  EXPECT_LT((motion.rotation->axis - Vector3(0, 0.6, 0.8)).norm(), kRounding);
  EXPECT_EQ(motion.rotation->center, transform.center);
  EXPECT_LT((motion.map.linear() - rotation_matrix(-40, {0, 3, 4})).norm(), kRounding);
}

TEST(HandleTransform, InvalidValuesAreRefused) {
  const auto refused = [](ErrorCause cause, const auto& spoil) {
    HandleTransform transform = rotation(10, {0, 0, 1});
    spoil(transform);
    support::expect_refusal(cause, [&] { resolve(transform, kCentre); });
  };
  refused(ErrorCause::BadParameter, [](HandleTransform& t) { t.axis.setZero(); });
  refused(ErrorCause::BadParameter, [](HandleTransform& t) { t.scale = 0; });
  refused(ErrorCause::BadParameter, [](HandleTransform& t) { t.scale = -1; });
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    refused(ErrorCause::NotFinite, [&](HandleTransform& t) { t.scale = bad; });
    refused(ErrorCause::NotFinite, [&](HandleTransform& t) { t.degrees = bad; });
    refused(ErrorCause::NotFinite, [&](HandleTransform& t) { t.axis[1] = bad; });
    refused(ErrorCause::NotFinite, [&](HandleTransform& t) { t.translation[2] = bad; });
    refused(ErrorCause::NotFinite, [&](HandleTransform& t) { t.center = Vector3(0, bad, 0); });
    refused(ErrorCause::NotFinite, [&](HandleTransform& t) { t.matrix = Matrix34::Constant(bad); });
  }
}

TEST(HandleTransform, AxisOfNoRotationMayBeZero) {
  EXPECT_EQ(resolve(rotation(0, {0, 0, 0}), kCentre).map.matrix(), Affine::Identity().matrix());
}

using support::rigid;
using support::shift;

const std::vector<Vector3> kPositions = {kCentre, Vector3(2, -2, 0.5), Vector3(0.3, -1, 1.5), Vector3(1, -4, -2)};
const std::vector<double> kFractions = {0, 0.1, 1.0 / 3, 0.5, 0.9, 0.999, 1};

constexpr double kUnit = 0.1;  // a step of a path

HandleMotion turned(double degrees, const Vector3& axis, const Vector3& way,
                    const std::optional<Vector3>& center = std::nullopt) {
  HandleTransform transform = rotation(degrees, axis);
  transform.translation = way;
  transform.center = center;
  return resolve(transform, kCentre);
}

MotionPath path_of(const HandleMotion& target) {
  return {target, Vector3::Zero(), kCentre};
}

Vector3 position_after(const MotionPath& path, const Vector3& rest, double fraction) {
  return rest + path.at(fraction).displacement(rest);
}

std::vector<HandleMotion> some_motions() {
  Affine shear = rigid(70, Vector3(1, 0, 2), Vector3(0.3, 0, 1), kCentre), flat = shear,
         point = shift(Vector3(1, 1, 1));
  shear.linear() *= (Matrix3() << 1.5, 0.4, 0, 0, 0.7, 0, 0.2, 0, 1).finished();
  flat.linear() *= Vector3(1, 1, 0).asDiagonal();
  point.linear().setZero();
  return {Affine::Identity(),
          shift(Vector3(1, 2, 3)),
          rigid(29, Vector3(1, 2, 3), Vector3(1, 0, 0)),
          rigid(140, Vector3(1, 2, 3), Vector3(1, 0, 0), kCentre),
          rigid(180, Vector3(0, 0, 1), Vector3(0, 0, 4)),
          Affine(Eigen::Scaling(2.5)),
          Affine(Eigen::Scaling(Vector3(1, 1, -1))),
          shear,
          flat,
          point,
          turned(270, Vector3(1, 1, 0), Vector3(1, 0, 2)),
          turned(-800, Vector3(1, 1, 0), Vector3(1, 0, 2), Vector3(3, 3, 3)),
          turned(360, Vector3(0, 0, 1), Vector3(0, 0, 0), Vector3(3, 3, 3))};
}

TEST(MotionPath, LeadsFromRestToTheTargetToTheBit) {
  for (const HandleMotion& target : some_motions()) {
    const MotionPath path = path_of(target);
    const LocalMotion whole = LocalMotion::of(target.map, Vector3::Zero());
    EXPECT_TRUE(path.at(0).none());
    EXPECT_EQ(path.at(1).linear, whole.linear);
    EXPECT_EQ(path.at(1).translation, whole.translation);
    for (const Vector3& rest : kPositions) {
      for (const double fraction : {0.0, 0.3, 0.5, 1 - 1e-9}) {
        const Vector3 here = position_after(path, rest, fraction);
        EXPECT_TRUE(here.allFinite());
        EXPECT_LT((position_after(path, rest, fraction + 1e-9) - here).norm(), 2e-7) << "a jump at " << fraction;
      }
    }
  }
}

TEST(MotionPath, RotationAboutAFarPivotKeepsTheDistanceFromIt) {
  const Vector3 pivot(40, 3, -7), axis(0.2, 1, 0.4);
  for (const double degrees : {31.0, 90.0, 150.0, 179.0, 180.0}) {
    for (const MotionPath& path : {path_of(rigid(degrees, axis, Vector3::Zero(), pivot)),
                                   path_of(turned(degrees + 360, axis, Vector3::Zero(), pivot))}) {
      for (const Vector3& rest : kPositions) {
        for (const double fraction : kFractions) {
          EXPECT_NEAR((position_after(path, rest, fraction) - pivot).norm(), (rest - pivot).norm(), 1e-11) << degrees;
        }
      }
    }
  }
}

TEST(MotionPath, RotatesEvenlyAndCountsRevolutions) {
  for (const double degrees : {45.0, 90.0, 179.0, 180.0, 270.0, -300.0, 360.0, 1000.0}) {
    const MotionPath path = path_of(turned(degrees, Vector3::UnitZ(), Vector3(0, 0, 2)));
    for (const double fraction : kFractions) {
      const Matrix3 expected = Eigen::AngleAxisd(fraction * degrees * kPi / 180, Vector3::UnitZ()).matrix();
      EXPECT_LT((path.at(fraction).linear + Matrix3::Identity() - expected).norm(), 1e-13)
          << degrees << ", " << fraction;
      EXPECT_LT((path.at(fraction).displacement(kCentre) - Vector3(0, 0, 2 * fraction)).norm(), 1e-13);
    }
  }
}

/// Fails if a map does not rotate at the same rate: affine maps do not know their number of revolutions.
TEST(MotionPath, MapRotatesByLessThanHalfARevolution) {
  const Vector3 axis(1, 2, 3);
  for (const double degrees : {1.0, 100.0, 179.9, 200.0, 330.0, -45.0}) {
    const double least = std::remainder(degrees, 360);
    const MotionPath path = path_of(rigid(degrees, axis, Vector3(1, 0, 0), kCentre));
    const Matrix3 expected = Eigen::AngleAxisd(0.25 * least * kPi / 180, axis.normalized()).toRotationMatrix();
    EXPECT_LT((path.at(0.25).linear + Matrix3::Identity() - expected).norm(), 1e-9) << degrees;
  }
}

/// Scripts' fractions lie on the path of the whole.
TEST(MotionPath, PathOfAMapIsTheBeginningOfALongerOne) {
  const Affine whole = rigid(120, Vector3(1, 2, 3), Vector3(1, 0, 4), kCentre);
  const LocalMotion half = path_of(whole).at(0.5);
  Affine to = Affine::Identity();
  to.linear() += half.linear;
  to.translation() = half.translation;
  for (const Vector3& rest : kPositions) {
    EXPECT_LT((position_after(path_of(to), rest, 0.5) - position_after(path_of(whole), rest, 0.25)).norm(), 1e-12);
  }
}

TEST(MotionPath, LengthCountsRotationsTranslationsAndStretches) {
  const Vector3 axis(1, 2, 3);
  for (const double degrees : {0.0, 15.0, 60.0, 180.0}) {
    EXPECT_NEAR(path_of(rigid(degrees, axis, Vector3::Zero(), kCentre)).length(kUnit), degrees / 30, 1e-9);
  }
  EXPECT_NEAR(path_of(turned(-720, axis, Vector3::Zero())).length(kUnit), 24, 1e-9);
  EXPECT_NEAR(path_of(shift(Vector3(0, 3, 4))).length(kUnit), 50, 1e-9);
  EXPECT_GT(path_of(Affine(Eigen::Scaling(7.0))).length(kUnit), 20);
  EXPECT_EQ(path_of(Affine::Identity()).length(kUnit), 0);
}

TEST(MotionPath, ScaleAndShearFadeIn) {
  const Vector3 way(0.5, 1, -2);
  Affine scaled = shift(kCentre + way) * Eigen::Scaling(3.0) * shift(-kCentre);
  const MotionPath growing = path_of(scaled);
  for (const Vector3& rest : kPositions) {
    for (const double fraction : kFractions) {
      const Vector3 expected = fraction * (2 * (rest - kCentre) + way);
      EXPECT_LT((growing.at(fraction).displacement(rest) - expected).norm(), 1e-13);
    }
  }
  // After a rotation the stretch is what it is without one.
  Matrix3 stretch;
  stretch << 1.4, 0.3, 0, 0.3, 0.9, 0.1, 0, 0.1, 1.1;
  Affine both = rigid(100, Vector3(1, 1, 0), Vector3(2, 0, 0), kCentre);
  both.linear() *= stretch;
  both.translation() = kCentre + Vector3(2, 0, 0) - both.linear() * kCentre;
  const MotionPath path = path_of(both);
  for (const double fraction : {0.25, 0.5, 0.75}) {
    const Matrix3 expected = Matrix3::Identity() + fraction * (stretch - Matrix3::Identity());
    const Vector3 middle = position_after(path, kCentre, fraction);
    for (const Vector3& rest : kPositions) {
      EXPECT_NEAR((position_after(path, rest, fraction) - middle).norm(), (expected * (rest - kCentre)).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace lapedit::handle_transform_test
