// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/anderson_mixing.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "allocation_watch.h"
#include "support.h"

namespace lapedit {
namespace {

constexpr int kWindow = 5;
using Map = std::function<Points(const Points&)>;

Points spread_points(int rows) {
  return Points::NullaryExpr(rows, 3, [](Eigen::Index i, Eigen::Index k) { return std::sin(1.3 * i + 2.1 * k + 0.7); });
}

/// x -> A x + b, A diagonal with eigenvalues from `least` to `largest`.
Map contraction(int rows, double least, double largest) {
  const Eigen::VectorXd factors = Eigen::VectorXd::LinSpaced(rows, least, largest);
  const Points shift = spread_points(rows);
  return [=](const Points& x) { return Points(factors.asDiagonal() * x + shift); };
}

Points fixed_point(int rows, double least, double largest) {
  const Eigen::VectorXd factors = Eigen::VectorXd::LinSpaced(rows, least, largest);
  return (1 - factors.array()).inverse().matrix().asDiagonal() * spread_points(rows);
}

/// How many steps it takes from zero to the fixed point, to a part of it.
int steps_to(const Map& map, const Points& fixed, double accurate, bool mix) {
  constexpr int kMost = 5000;
  AndersonMixing mixing(kWindow);
  Points x = Points::Zero(fixed.rows(), 3);
  for (int step = 0; step < kMost; ++step) {
    if ((x - fixed).norm() < accurate * fixed.norm()) {
      return step;
    }
    Points g = map(x);
    if (mix) {
      mixing.step(x, g);
    } else {
      x = g;
    }
  }
  return kMost;
}

/// Of d different eigenvalues, d + 1 steps know the map. Fails if a step is stored in the wrong slot, the signs are
/// wrong or the window is shorter than it is said to be.
TEST(AndersonMixing, FindsTheFixedPointOfALinearMapInAsManyStepsAsDimensions) {
  for (int dimensions = 1; dimensions <= kWindow; ++dimensions) {
    const Map map = contraction(dimensions, -0.5, 0.9);
    const Points fixed = fixed_point(dimensions, -0.5, 0.9);
    EXPECT_LE(steps_to(map, fixed, 1e-6, true), dimensions + 3) << dimensions;
    EXPECT_GT(steps_to(map, fixed, 1e-6, false), 15) << dimensions << ": there is nothing to gain";
  }
}

TEST(AndersonMixing, TakesFewerStepsWhereTheMapContractsSlowly) {
  const Map map = contraction(40, 0, 0.99);
  const Points fixed = fixed_point(40, 0, 0.99);
  const int plain = steps_to(map, fixed, 1e-6, false), mixed = steps_to(map, fixed, 1e-6, true);
  EXPECT_GT(plain, 800);
  EXPECT_LT(mixed, plain / 4) << plain;
}

/// Fails if what was known of one map is used for another one.
TEST(AndersonMixing, StartsAnewWhereTheMapJumps) {
  const Map map = contraction(12, 0, 0.9);
  const Points fixed = fixed_point(12, 0, 0.9), jump = Points::Constant(12, 3, 1e4);
  for (const bool told : {false, true}) {
    AndersonMixing mixing(kWindow);
    Points x = Points::Zero(12, 3), g;
    for (int step = 0; step < 8; ++step) {
      g = map(x);
      mixing.step(x, g);
    }
    if (told) {
      mixing.restart();
    }
    const Points asked = told ? map(x) : Points(map(x) + jump);
    g = asked;
    mixing.step(x, g);
    EXPECT_TRUE(support::same_bits(x, asked)) << "the first step of a map takes what it gives";
    for (int step = 0; step < 60; ++step) {
      g = map(x);
      mixing.step(x, g);
    }
    EXPECT_LT((x - fixed).norm(), 1e-9 * fixed.norm());
  }
}

/// Fails if the steps' differences, then zero, are divided by.
TEST(AndersonMixing, StaysWhereNothingChanges) {
  const Points there = spread_points(9);
  AndersonMixing mixing(kWindow);
  Points x = Points::Zero(9, 3), g;
  for (int step = 0; step < 20; ++step) {
    g = there;
    mixing.step(x, g);
    ASSERT_TRUE(support::same_bits(x, there)) << step;
  }
}

TEST(AndersonMixing, RecoversFromWhatIsNotANumber) {
  const Map map = contraction(4, 0, 0.9);
  AndersonMixing mixing(kWindow);
  Points x = Points::Zero(4, 3), g;
  for (int step = 0; step < 6; ++step) {
    g = step == 3 ? Points::Constant(4, 3, std::numeric_limits<double>::quiet_NaN()) : map(x);
    mixing.step(x, g);
  }
  x.setZero();
  for (int step = 0; step < 12; ++step) {
    g = map(x);
    mixing.step(x, g);
  }
  EXPECT_LT((x - fixed_point(4, 0, 0.9)).norm(), 1e-6);
}

TEST(AndersonMixing, AllocatesNothingAfterTheFirstStep) {
  const Points there = spread_points(30);
  AndersonMixing mixing(kWindow);
  Points x = Points::Zero(30, 3), g = there;
  const long before_all = allocations;
  mixing.step(x, g);
  ASSERT_GT(allocations.load(), before_all);  // or the count does not count
  const long before = allocations;
  for (int step = 0; step < 12; ++step) {
    g = x;
    g *= 0.5;
    g += there;
    mixing.step(x, g);
  }
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace lapedit
