// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/handle_transform.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "base_support.h"

namespace lapedit::handle_transform_test {
namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-14;  // a few units in the last digit of numbers around 10
const Vector3 kCentroid(1, -2, 0.5);

Matrix3 rotation_matrix(double degrees, const Vector3& axis) {
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

TEST(HandleTransform, TargetOfAMatrixIsThatMatrixBitForBit) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const HandleTransform transform = affine(random_matrix(seed), {0.1, 1e9, -1e-9});
    EXPECT_EQ(resolve(transform, kCentroid).map.matrix(), *transform.matrix);
  }
}

TEST(HandleTransform, TargetOfATranslationOrScaleIsExact) {
  HandleTransform transform;
  transform.translation = {0.1, -1e-9, 1e9};
  EXPECT_EQ(resolve(transform, kCentroid).map.translation(), transform.translation);
  for (const double scale : {0.1, 0.7, 1.1, 3.3, 1e-9, 1e9}) {
    transform.scale = scale;
    EXPECT_EQ(resolve(transform, kCentroid).map.linear(), scale * Matrix3::Identity());
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
  EXPECT_LT((resolve(transform, kCentroid).map * point - expected(kCentroid)).norm(), kRounding);
  transform.center = Vector3(10, 0, -3);
  EXPECT_LT((resolve(transform, kCentroid).map * point - expected({10, 0, -3})).norm(), 4 * kRounding);
}

TEST(HandleTransform, LengthOfTheAxisDoesNotMatter) {
  const Matrix3 expected = rotation_matrix(40, {1, 2, 2});
  for (const double length : {1e-300, 1e-160, 1.0, 1e160, 1e300}) {
    EXPECT_LT((resolve(rotation(40, length * Vector3(1, 2, 2)), kCentroid).map.linear() - expected).norm(), kRounding)
        << length;
  }
}

/// A map does not know its number of revolutions.
TEST(HandleTransform, KeepsAxisAndRevolutions) {
  HandleTransform transform = rotation(-400, {0, 3, 4});
  transform.center = Vector3(1, 1, 1);
  const HandleMotion motion = resolve(transform, kCentroid);
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
    support::expect_refusal(cause, [&] { resolve(transform, kCentroid); });
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
  EXPECT_EQ(resolve(rotation(0, {0, 0, 0}), kCentroid).map.matrix(), Affine::Identity().matrix());
}

}  // namespace
}  // namespace lapedit::handle_transform_test
