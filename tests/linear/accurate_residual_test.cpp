// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/accurate_residual.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "linear/operators.h"

namespace lapedit::accurate_residual_test {
namespace {

// 113 bits, also where long double has them (arm64).
#ifdef __SIZEOF_FLOAT128__
__extension__ using Quad = __float128;
#else
using Quad = long double;
static_assert(std::numeric_limits<Quad>::digits == 113, "This test needs quadruple precision.");
#endif

Points random_points(Eigen::Index n, std::mt19937& random) {
  return Points::NullaryExpr(n, 3, [&] { return random() / 2147483648.0 - 1; });
}

Quad sum_of(const DoubledPoints& x, Eigen::Index row, Eigen::Index column) {
  return static_cast<Quad>(x.high(row, column)) + static_cast<Quad>(x.low(row, column));
}

TEST(AccurateResidual, AddsWithoutLosingWhatIsSmall) {
  std::mt19937 random(1);
  ThreadPool pool(2);
  DoubledPoints x;
  x.set(random_points(50, random));
  std::vector<Quad> expected;
  for (Eigen::Index i = 0; i < 150; ++i) {
    expected.push_back(sum_of(x, i / 3, i % 3));
  }
  for (const double scale : {1e-3, 1e-9, 1e-17, 1e-22}) {
    const Points step = scale * random_points(50, random);
    x.add(step, pool);
    for (Eigen::Index i = 0; i < 150; ++i) {
      expected[static_cast<std::size_t>(i)] += static_cast<Quad>(step(i / 3, i % 3));
    }
  }
  for (Eigen::Index i = 0; i < 150; ++i) {
    const Quad error = sum_of(x, i / 3, i % 3) - expected[static_cast<std::size_t>(i)];
    EXPECT_LE(std::fabs(static_cast<double>(error)), 1e-31);
    EXPECT_EQ(x.high(i / 3, i % 3), static_cast<double>(expected[static_cast<std::size_t>(i)]));
  }
}

TEST(AccurateResidual, IsThatOfQuadruplePrecision) {
  std::mt19937 random(2);
  const SparseMatrix first = support::laplacian(support::surface(support::Surface::Tube, 30, 110), true).matrix,
                     m = first * first;
  const Eigen::Index n = m.cols();
  DoubledPoints x, between;
  x.set(random_points(n, random));
  ThreadPool alone(1);
  x.add(1e-18 * random_points(n, random), alone);
  const Eigen::VectorXd diagonal = random_points(n, random).col(0).cwiseAbs();

  Eigen::Matrix<Quad, Eigen::Dynamic, 3> product(n, 3), expected(n, 3);
  for (Eigen::Index c = 0; c < 3; ++c) {
    for (Eigen::Index i = 0; i < n; ++i) {
      product(i, c) = 0;
      expected(i, c) = static_cast<Quad>(diagonal[i]) * sum_of(x, i, c);
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      for (SparseMatrix::InnerIterator entry(m, j); entry; ++entry) {
        product(entry.row(), c) += static_cast<Quad>(entry.value()) * sum_of(x, j, c);
      }
    }
    for (Eigen::Index j = 0; j < n; ++j) {
      for (SparseMatrix::InnerIterator entry(m, j); entry; ++entry) {
        expected(j, c) += static_cast<Quad>(entry.value()) * product(entry.row(), c);
      }
    }
  }
  // Right-hand sides with next to nothing left after the product, as at the end of a refinement.
  Points right(n, 3), out;
  for (Eigen::Index i = 0; i < 3 * n; ++i) {
    right(i / 3, i % 3) = static_cast<double>(expected(i / 3, i % 3));
  }
  const double terms = right.cwiseAbs().maxCoeff();
  for (const int threads : {1, 2}) {
    ThreadPool pool(threads);
    normal_residual(OperatorRows(m), diagonal, right, x, between, out, pool);
    double most = 0;
    for (Eigen::Index i = 0; i < 3 * n; ++i) {
      const Quad rest = static_cast<Quad>(right(i / 3, i % 3)) - expected(i / 3, i % 3);
      most = std::max(most, std::fabs(static_cast<double>(static_cast<Quad>(out(i / 3, i % 3)) - rest)));
    }
    EXPECT_LE(most, 1e-28 * terms);
    EXPECT_GT(out.cwiseAbs().maxCoeff(), 0) << "nothing was left to be measured";
  }
}

TEST(AccurateResidual, FollowsFromASmallStepInWorkingPrecision) {
  std::mt19937 random(6);
  const SparseMatrix m = support::laplacian(support::surface(support::Surface::Tube, 30, 40)).matrix;
  const SparseMatrix a = SparseMatrix(m.transpose()) + m;
  const Eigen::VectorXd diagonal = random_points(m.cols(), random).col(0);
  const Points step = random_points(m.cols(), random), start = random_points(m.cols(), random);
  ThreadPool pool(2);
  Points between, left = start;
  subtract_normal_product(OperatorRows(m), diagonal, step, between, left, pool);
  const Points normal = m.transpose() * (m * step).eval() + diagonal.asDiagonal() * step;
  EXPECT_LT((left - (start - normal)).cwiseAbs().maxCoeff(), 1e-13);
  left = start;
  subtract_symmetric_product(a, step, left, pool);
  EXPECT_LT((left - (start - a * step)).cwiseAbs().maxCoeff(), 1e-13);
}

}  // namespace
}  // namespace lapedit::accurate_residual_test
