// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/handle_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "lapedit/base/error.h"

namespace lapedit {
namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-14;  // a few units in the last place of numbers around 10
const Vector3 kCentroid(1, -2, 0.5);

Matrix3 turn(double degrees, const Vector3& axis) {
  return Eigen::AngleAxisd(degrees * kPi / 180, axis.normalized()).toRotationMatrix();
}

HandleTransform rotation(double degrees, const Vector3& axis) {
  HandleTransform transform;
  transform.degrees = degrees;
  transform.axis = axis;
  return transform;
}

HandleTransform affine(const Matrix3& linear, const Vector3& translation) {
  HandleTransform transform;
  transform.matrix.emplace();
  *transform.matrix << linear, translation;
  return transform;
}

Matrix3 random_matrix(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  return Matrix3::NullaryExpr([&] { return number(random); });
}

/// A translation, a turn, a scale, all three, and matrices: a turn, a stretch, a mirror, a projection, any.
std::vector<HandleTransform> various() {
  std::vector<HandleTransform> all(4);
  all[0].translation = {0.1, -0.2, 0.3};
  all[1] = rotation(33, {1, 2, 3});
  all[2].scale = 1.7;
  all[3] = rotation(-100, {0, 1, 1});
  all[3].translation = {1, 2, 3};
  all[3].scale = 0.3;
  all[3].center = Vector3(4, 5, 6);
  all.push_back(affine(turn(70, {1, 0, 1}), {1, 2, 3}));
  all.push_back(affine(Vector3(2, 0.5, 1).asDiagonal(), {0, 0, 1}));
  all.push_back(affine(Vector3(-1, 1, 1).asDiagonal(), {0, 0, 1}));
  all.push_back(affine(Vector3(1, 1, 0).asDiagonal(), {0, 0, 1}));
  for (unsigned seed = 0; seed < 20; ++seed) {
    all.push_back(affine(random_matrix(seed), {3, 2, 1}));
  }
  return all;
}

TEST(HandleTransform, FractionZeroIsExactlyTheIdentity) {
  for (const HandleTransform& transform : various()) {
    EXPECT_EQ(resolve(transform, kCentroid, 0).matrix(), Affine::Identity().matrix());
  }
}

TEST(HandleTransform, NothingGivenIsExactlyTheIdentity) {
  for (const double fraction : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(resolve(HandleTransform(), kCentroid, fraction).matrix(), Affine::Identity().matrix());
  }
}

TEST(HandleTransform, FractionOneOfAMatrixIsThatMatrixBitForBit) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const HandleTransform transform = affine(random_matrix(seed), {0.1, 1e9, -1e-9});
    EXPECT_EQ(resolve(transform, kCentroid).matrix(), *transform.matrix);
  }
}

TEST(HandleTransform, FractionOneOfATranslationOrScaleIsExact) {
  HandleTransform transform;
  transform.translation = {0.1, -1e-9, 1e9};
  EXPECT_EQ(resolve(transform, kCentroid).translation(), transform.translation);
  for (const double scale : {0.1, 0.7, 1.1, 3.3, 1e-9, 1e9}) {
    transform.scale = scale;
    EXPECT_EQ(resolve(transform, kCentroid).linear(), scale * Matrix3::Identity());
  }
}

TEST(HandleTransform, RotatesAndScalesAboutTheCenterThenTranslates) {
  HandleTransform transform = rotation(50, {1, 2, -1});
  transform.scale = 1.5;
  transform.translation = {3, 4, 5};
  const Vector3 point(-1, 2, 7);
  const auto expected = [&](const Vector3& center) {
    return Vector3(center + 1.5 * turn(50, {1, 2, -1}) * (point - center) + transform.translation);
  };
  EXPECT_LT((resolve(transform, kCentroid) * point - expected(kCentroid)).norm(), kRounding);
  transform.center = Vector3(10, 0, -3);
  EXPECT_LT((resolve(transform, kCentroid) * point - expected({10, 0, -3})).norm(), 4 * kRounding);
}

TEST(HandleTransform, RotationIsRightHanded) {
  EXPECT_LT((resolve(rotation(90, {0, 0, 2}), Vector3::Zero()) * Vector3(1, 0, 0) - Vector3(0, 1, 0)).norm(),
            kRounding);
}

TEST(HandleTransform, LengthOfTheAxisDoesNotMatter) {
  const Matrix3 expected = turn(40, {1, 2, 2});
  for (const double length : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
    EXPECT_LT((resolve(rotation(40, length * Vector3(1, 2, 2)), kCentroid).linear() - expected).norm(), kRounding)
        << length;
  }
}

TEST(HandleTransform, PartOfTheWayRotatesByAngle) {
  for (const double degrees : {90.0, 180.0, 360.0, -720.0}) {
    const Affine map = resolve(rotation(degrees, {1, 1, 0}), kCentroid, 1.0 / 3);
    EXPECT_LT((map.linear() - turn(degrees / 3, {1, 1, 0})).norm(), kRounding) << degrees;
    EXPECT_LT((map * kCentroid - kCentroid).norm(), kRounding) << degrees;
  }
}

TEST(HandleTransform, PartOfTheWayScalesAndTranslatesLinearly) {
  HandleTransform transform;
  transform.scale = 3;
  transform.translation = {4, 0, -8};
  const Affine map = resolve(transform, kCentroid, 0.25);
  EXPECT_LT((map.linear() - 1.5 * Matrix3::Identity()).norm(), kRounding);
  EXPECT_LT((map * kCentroid - kCentroid - Vector3(1, 0, -2)).norm(), kRounding);
}

TEST(HandleTransform, HalfOfAHalfTurnMatrixIsAQuarterTurn) {
  for (const Vector3& axis : {Vector3(0, 0, 1), Vector3(1, 2, 3), Vector3(-1, 0, 1)}) {
    const Matrix3 half_turn = turn(180, axis);
    const Affine map = resolve(affine(half_turn, kCentroid - half_turn * kCentroid), kCentroid, 0.5);
    const Eigen::AngleAxisd found(map.linear());
    EXPECT_NEAR(found.angle(), kPi / 2, 1e-7);  // the axis of a half turn is known to half the digits
    EXPECT_NEAR(std::abs(found.axis().dot(axis.normalized())), 1, 1e-7);
    EXPECT_LT((map.linear() * map.linear() - half_turn).norm(), 1e-7);
    EXPECT_LT((map * kCentroid - kCentroid).norm(), kRounding);
  }
}

TEST(HandleTransform, MatrixGoesByRotationAndStretch) {
  const Matrix3 frame = turn(25, {3, -1, 2});
  const auto stretch = [&](double a, double b, double c) {
    return Matrix3(frame * Vector3(a, b, c).asDiagonal() * frame.transpose());
  };
  const HandleTransform transform = affine(turn(120, {1, 2, 3}) * stretch(2, 1, 0.5), {1, 2, 3});
  const Matrix3 expected = turn(30, {1, 2, 3}) * stretch(1.25, 1, 0.875);
  EXPECT_LT((resolve(transform, kCentroid, 0.25).linear() - expected).norm(), kRounding);
}

TEST(HandleTransform, CentroidOfAMatrixGoesStraight) {
  for (const HandleTransform& transform : various()) {
    if (transform.matrix) {
      const Vector3 end = resolve(transform, kCentroid) * kCentroid;
      const Vector3 expected = kCentroid + 0.3 * (end - kCentroid);
      EXPECT_LT((resolve(transform, kCentroid, 0.3) * kCentroid - expected).norm(), kRounding);
    }
  }
}

TEST(HandleTransform, WayHasNoJumps) {
  constexpr double kStep = 1e-9;
  for (const HandleTransform& transform : various()) {
    for (const double fraction : {0.0, 0.4, 1 - kStep}) {
      const Affine here = resolve(transform, kCentroid, fraction);
      const Affine next = resolve(transform, kCentroid, fraction + kStep);
      EXPECT_LT((next.matrix() - here.matrix()).norm(), 100 * kStep) << here.matrix() << "\n\n" << next.matrix();
    }
  }
}

TEST(HandleTransform, ReflectionGoesLinearly) {
  const Matrix3 mirror = Matrix3::Identity() - 2 * Vector3(0.6, 0.8, 0) * Vector3(0.6, 0.8, 0).transpose();
  const HandleTransform transform = affine(mirror, {0, 0, 1});
  const Affine map = resolve(transform, kCentroid, 0.25);
  EXPECT_LT((map.linear() - (0.75 * Matrix3::Identity() + 0.25 * mirror)).norm(), kRounding);
}

TEST(HandleTransform, ZeroMatrixIsFinite) {
  const Affine map = resolve(affine(Matrix3::Zero(), {1, 2, 3}), kCentroid, 0.5);
  EXPECT_TRUE(map.matrix().allFinite());
}

TEST(HandleTransform, InvalidValuesAreRefused) {
  const auto cause = [](const auto& spoil, double fraction = 1) {
    HandleTransform transform = rotation(10, {0, 0, 1});
    spoil(transform);
    for (const double part : {fraction, 0.0}) {  // even if nothing is to move
      try {
        resolve(transform, kCentroid, part);
        ADD_FAILURE() << "was taken";
      } catch (const EditError& error) {
        EXPECT_STRNE(error.what(), "");
        if (part == 0.0) return error.cause();
      }
    }
    return ErrorCause::Cancelled;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cause([](HandleTransform& t) { t.axis.setZero(); }), ErrorCause::BadParameter);
  EXPECT_EQ(cause([](HandleTransform& t) { t.scale = 0; }), ErrorCause::BadParameter);
  EXPECT_EQ(cause([](HandleTransform& t) { t.scale = -1; }), ErrorCause::BadParameter);
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(cause([&](HandleTransform& t) { t.scale = bad; }), ErrorCause::NotFinite);
    EXPECT_EQ(cause([&](HandleTransform& t) { t.degrees = bad; }), ErrorCause::NotFinite);
    EXPECT_EQ(cause([&](HandleTransform& t) { t.axis[1] = bad; }), ErrorCause::NotFinite);
    EXPECT_EQ(cause([&](HandleTransform& t) { t.translation[2] = bad; }), ErrorCause::NotFinite);
    EXPECT_EQ(cause([&](HandleTransform& t) { t.center = Vector3(0, bad, 0); }), ErrorCause::NotFinite);
    EXPECT_EQ(cause([&](HandleTransform& t) {
                t.matrix = Matrix34::Identity();
                (*t.matrix)(1, 3) = bad;
              }),
              ErrorCause::NotFinite);
    EXPECT_THROW(resolve(HandleTransform(), kCentroid, bad), EditError);
  }
}

TEST(HandleTransform, AxisOfNoRotationMayBeZero) {
  EXPECT_EQ(resolve(rotation(0, {0, 0, 0}), kCentroid).matrix(), Affine::Identity().matrix());
}

}  // namespace
}  // namespace lapedit
