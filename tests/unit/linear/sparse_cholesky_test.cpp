// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/linear.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "lapedit/base/error.h"
#include "linear/operators.h"

namespace lapedit::sparse_cholesky_test {
namespace {

using support::random_points;

/// Graph Laplacian of a width x height grid, with diagonal more on the diagonal.
SparseMatrix grid_laplacian(int width, int height, double diagonal) {
  const int n = width * height;
  std::vector<Eigen::Triplet<double>> entries;
  const auto connect = [&](int a, int b) {
    entries.insert(entries.end(), {{a, a, 1}, {b, b, 1}, {a, b, -1}, {b, a, -1}});
  };
  for (int i = 0; i < n; ++i) {
    if (i % width + 1 < width) connect(i, i + 1);
    if (i + width < n) connect(i, i + width);
    entries.emplace_back(i, i, diagonal);
  }
  SparseMatrix matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// A random sparse matrix times its transpose, plus the identity.
SparseMatrix random_positive_definite(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> position(0, n - 1);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(4 * static_cast<std::size_t>(n));
  for (int i = 0; i < 3 * n; ++i) {
    // One statement each: compilers evaluate arguments in different orders.
    const double value = number(random);
    const int column = position(random);
    const int row = position(random);
    entries.emplace_back(row, column, value);
  }
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1);
  SparseMatrix root(n, n);
  root.setFromTriplets(entries.begin(), entries.end());
  return root * SparseMatrix(root.transpose());
}

ErrorCause refusal(const SparseMatrix& matrix) {
  try {
    SparseCholesky factor(matrix);
  } catch (const EditError& error) {
    EXPECT_STRNE(error.what(), "");
    return error.cause();
  }
  return ErrorCause::Cancelled;  // none
}

TEST(SparseCholesky, AgreesWithADenseSolve) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const int n = 1 + 20 * static_cast<int>(seed);
    const SparseMatrix matrix = random_positive_definite(n, seed);
    const Points rhs = random_points(n, seed + 100);
    SparseCholesky factor(matrix);
    Points x;
    factor.solve(rhs, x);
    const Points expected = Eigen::MatrixXd(matrix).ldlt().solve(rhs);
    ASSERT_EQ(x.rows(), n);
    // Both solves are backward stable, and the condition numbers of these matrices stay below 1e4.
    EXPECT_LT((x - expected).norm(), 1e-11 * expected.norm()) << n << " unknowns";
  }
}

TEST(SparseCholesky, ReadsTheLowerHalfOnly) {
  const SparseMatrix matrix = grid_laplacian(7, 6, 0.1);
  SparseMatrix lower = matrix.triangularView<Eigen::Lower>();
  SparseMatrix spoiled = lower;
  spoiled += 5 * SparseMatrix(matrix.triangularView<Eigen::StrictlyUpper>());
  const Points rhs = random_points(42, 1);
  Points whole, half, other;
  SparseCholesky(matrix).solve(rhs, whole);
  SparseCholesky(lower).solve(rhs, half);
  SparseCholesky(spoiled).solve(rhs, other);
  EXPECT_LT((matrix * whole - rhs).norm(), 1e-12);
  EXPECT_LT((half - whole).norm(), 1e-12);
  EXPECT_LT((other - whole).norm(), 1e-12);
}

TEST(SparseCholesky, SolvesInPlace) {
  const SparseMatrix matrix = grid_laplacian(20, 30, 0.01);
  const Points rhs = random_points(600, 2);
  SparseCholesky factor(matrix);
  Points apart;
  factor.solve(rhs, apart);
  Points in_place = rhs;
  factor.solve(in_place, in_place);
  EXPECT_TRUE(in_place == apart);
}

TEST(SparseCholesky, CopiesSolveAtATimeAndOutliveTheOther) {
  const SparseMatrix matrix = grid_laplacian(90, 70, 1e-3);
  const Points rhs = random_points(90 * 70, 1);
  for (const bool single : {false, true}) {
    CholeskyOptions options;
    options.single_precision = single;
    auto factor = std::make_unique<SparseCholesky>(matrix, options);
    Points expected;
    factor->solve(rhs, expected);
    std::vector<SparseCholesky> copies;
    for (int threads = 1; threads <= 3; ++threads) {
      copies.emplace_back(*factor, std::make_shared<ThreadPool>(threads));
    }
    EXPECT_EQ(copies[0].single_precision(), factor->single_precision());
    factor.reset();
    std::vector<Points> found(copies.size());
    ThreadPool(static_cast<int>(copies.size())).each(static_cast<int>(copies.size()), [&](int c) {
      for (int time = 0; time < 20; ++time) {
        copies[c].solve(rhs, found[c]);
        copies[c].solve(found[c] * 1e3, found[c]);
        copies[c].solve(rhs, found[c]);
      }
    });
    for (const Points& x : found) {
      EXPECT_TRUE((x.array() == expected.array()).all());
    }
  }
}

TEST(SparseCholesky, MatricesThatAreNotPositiveDefiniteAreRefused) {
  const SparseMatrix good = grid_laplacian(10, 10, 1);
  const auto with = [&good](int row, int column, double value) {
    SparseMatrix changed = good;
    changed.coeffRef(row, column) = value;
    return changed;
  };
  SparseMatrix empty_row = good;
  empty_row.prune([](int row, int column, double) { return row != 40 && column != 40; });
  const std::pair<const char*, SparseMatrix> bad[] = {
      {"indefinite", grid_laplacian(10, 10, -0.5)},
      {"negative", -good},
      {"zero", 0 * good},
      {"no entries", SparseMatrix(100, 100)},
      {"empty row", empty_row},
      {"one negative", with(99, 99, -1e-3)},
      {"NaN on the diagonal", with(50, 50, std::nan(""))},
      {"NaN off the diagonal", with(51, 50, std::nan(""))},
      {"infinite", with(51, 50, std::numeric_limits<double>::infinity())},
      {"singular", grid_laplacian(100, 1, 0)}};  // a path: its pivots are 1, 1, ..., 1, 0 without rounding
  for (const auto& [what, matrix] : bad) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const ErrorCause cause = refusal(matrix);
    const std::string noise = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
    EXPECT_EQ(cause, ErrorCause::IllConditioned) << what;
    EXPECT_EQ(noise, "") << what;  // a library's own message does not belong into the host's terminal
  }
  EXPECT_EQ(refusal(good), ErrorCause::Cancelled);
}

TEST(SparseCholesky, ThreadsDoNotChangeABit) {
  const SparseMatrix matrix = grid_laplacian(120, 90, 1e-3);
  const Points rhs = random_points(120 * 90, 8);
  Points expected;
  for (const int threads : {1, 2, 3}) {
    for (int time = 0; time < 5; ++time) {
      CholeskyOptions options;
      options.pool = std::make_shared<ThreadPool>(threads);
      Points x;
      SparseCholesky(matrix, options).solve(rhs, x);
      EXPECT_LT((matrix * x - rhs).norm(), 1e-10 * rhs.norm());
      if (expected.rows() == 0) {
        expected = x;
      }
      EXPECT_TRUE(x == expected) << threads << " threads";
    }
  }
}

TEST(SparseCholesky, ScaleOfTheMatrixDoesNotMatter) {
  const Points rhs = random_points(100, 7);
  const SparseMatrix matrix = grid_laplacian(10, 10, 0.1);
  for (const double scale : {1e-100, 1e-20, 1e20, 1e100}) {
    Points x;
    SparseCholesky(scale * matrix).solve(rhs, x);
    EXPECT_LT((scale * (matrix * x) - rhs).norm(), 1e-12) << scale;
  }
}

/// Of a matrix with other values in the same positions.
TEST(SparseCholesky, TakesOverAnAnalysis) {
  const SparseMatrix first = grid_laplacian(30, 20, 0.1);
  SparseMatrix second = first;
  second.coeffs() *= 2;
  second.diagonal().array() += 0.3;
  const Points right = random_points(600, 5);
  CholeskyOptions options;
  const SparseCholesky before(first, options);
  Points alone, shared;
  SparseCholesky(second, options).solve(right, alone);
  options.same_pattern = &before;
  SparseCholesky after(second, options);
  after.solve(right, shared);
  EXPECT_TRUE((alone.array() == shared.array()).all());
  const SparseMatrix other = grid_laplacian(31, 20, 0.1);
  Points x;
  SparseCholesky(other, options).solve(random_points(620, 6), x);
  EXPECT_LT((other * x - random_points(620, 6)).norm(), 1e-11) << "another pattern";
}

/// The work between two calls is a small fraction of all: there are many, and none follows the one that ends it.
TEST(SparseCholesky, CanBeCancelledBetweenSmallTasks) {
  const SparseMatrix matrix = grid_laplacian(120, 120, 0.1);
  const std::thread::id caller = std::this_thread::get_id();
  for (const int threads : {1, 3}) {
    CholeskyOptions options;
    options.pool = std::make_shared<ThreadPool>(threads);
    int calls = 0, last = 0;
    const Progress progress = [&](double, const char*) {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      return ++calls != last;
    };
    Points x;
    int all = 0;
    {
      const ProgressScope scope(progress);
      SparseCholesky cholesky(matrix, options);
      all = std::exchange(calls, 0);
      cholesky.solve(random_points(120 * 120, 1), x);
    }
    EXPECT_TRUE(x.allFinite());
    EXPECT_GE(all, threads == 1 ? 24 : 0);  // the others may have done all
    for (last = 1; last <= all; last += 5) {
      bool ended = false;
      calls = 0;
      const ProgressScope scope(progress);
      try {
        const SparseCholesky cholesky(matrix, options);
      } catch (const EditError&) {
        ended = true;
      }
      EXPECT_EQ(ended, calls >= last);
      EXPECT_LE(calls, last);
      EXPECT_TRUE(ended || threads > 1) << last;
    }
  }
}

}  // namespace
}  // namespace lapedit::sparse_cholesky_test
