// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/supernodal_solve.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "lapedit/linear/linear.h"
#include "linear/operators.h"

namespace lapedit::supernodal_solve_test {
namespace {

template <typename Scalar>
using Rows = Eigen::Matrix<Scalar, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A factor of random values and a matrix that has it.
struct Factor {
  std::string name;
  SupernodalPattern pattern;
  Eigen::MatrixXd dense;  // L

  SparseMatrix lower() const {
    const Eigen::MatrixXd matrix = (dense * dense.transpose()).triangularView<Eigen::Lower>();
    return matrix.sparseView();
  }
};

/// A factor whose elimination tree has the given parents (-1: a root), a column with up to `fill` % more rows than
/// its parent, in supernodes of random widths in a range: only columns of a path are merged.
Factor factor_of(const std::string& name, const std::vector<int>& parent, int fill, int narrowest, int widest,
                 unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&random] { return static_cast<double>(random()) / 2147483648.0 - 1; };
  const int n = static_cast<int>(parent.size());
  std::vector<std::vector<int>> below(n);  // rows of a column, all of them ancestors
  for (int j = 0; j < n; ++j) {
    for (int i = parent[j]; i >= 0; i = parent[i]) {
      if (i == parent[j] || static_cast<int>(random() % 100) < fill) {
        below[j].push_back(i);
      }
    }
  }
  for (int j = 0; j < n; ++j) {  // a column's rows are its parent's as well, but for the parent itself
    if (parent[j] >= 0) {
      std::vector<int>& up = below[parent[j]];
      up.insert(up.end(), below[j].begin() + 1, below[j].end());
      std::sort(up.begin(), up.end());
      up.erase(std::unique(up.begin(), up.end()), up.end());
    }
  }
  Factor factor;
  factor.name = name;
  factor.pattern.columns = factor.pattern.row_offsets = {0};
  factor.dense.setZero(n, n);
  for (int first = 0; first < n;) {
    const int wanted = narrowest + static_cast<int>(random() % static_cast<unsigned>(widest - narrowest + 1));
    int last = first;
    while (last + 1 < n && last + 1 - first < wanted && parent[last] == last + 1) {
      ++last;
    }
    std::vector<int> rows(last + 1 - first);
    std::iota(rows.begin(), rows.end(), first);
    rows.insert(rows.end(), below[last].begin(), below[last].end());
    for (int j = first; j <= last; ++j) {
      for (const int i : rows) {
        factor.dense(i, j) = i == j ? 1.5 + number() / 2 : i > j ? number() / std::sqrt(4.0 + n) : factor.dense(i, j);
      }
    }
    SupernodalPattern& pattern = factor.pattern;
    pattern.rows.insert(pattern.rows.end(), rows.begin(), rows.end());
    pattern.columns.push_back(last + 1);
    pattern.row_offsets.push_back(static_cast<int>(pattern.rows.size()));
    first = last + 1;
  }
  return factor;
}

std::vector<int> path(int n) {
  std::vector<int> parent(n);
  std::iota(parent.begin(), parent.end(), 1);
  parent.back() = -1;
  return parent;
}

/// A random forest in postorder: of a hundred columns, so many start a branch and so many join two.
std::vector<int> forest(int n, int starts, int joins, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> parent(n, -1), tops;
  for (int j = 0; j < n; ++j) {
    const int chance = static_cast<int>(random() % 100);
    for (int taken = chance < starts ? 2 : chance < starts + joins ? 0 : 1; taken < 2 && !tops.empty(); ++taken) {
      parent[tops.back()] = j;
      tops.pop_back();
    }
    tops.push_back(j);
  }
  return parent;
}

const std::vector<Factor>& factors() {
  static std::vector<Factor> all;
  if (!all.empty()) return all;
  for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 20, 40, 200}) {  // one supernode each
    all.push_back(factor_of("dense " + std::to_string(n), path(n), 100, n, n, static_cast<unsigned>(n)));
  }
  for (int widest = 1; widest <= 20; ++widest) {  // all numbers of rows below all widths
    all.push_back(factor_of("path " + std::to_string(widest), path(3 * widest + 30), 20, 1, widest, 40U + widest));
  }
  all.push_back(factor_of("diagonal", std::vector<int>(100, -1), 0, 1, 1, 5));
  for (unsigned seed = 0; seed < 24; ++seed) {
    const int widest = seed % 3 == 0 ? 1 : seed % 3 == 1 ? 5 : 20, starts = 2 + static_cast<int>(seed);
    const std::vector<int> trees = forest(seed % 2 == 0 ? 300 : 77, starts, starts - 1, seed);
    all.push_back(factor_of("forest " + std::to_string(seed), trees, 20, 1, widest, seed));
  }
  std::vector<int> alternating(100);  // two trees whose columns alternate: no branch is a run of columns
  for (int j = 0; j < 100; ++j) alternating[j] = j + 2 < 100 ? j + 2 : -1;
  all.push_back(factor_of("not in postorder", alternating, 20, 1, 1, 9));
  return all;
}

template <typename Scalar>
class SupernodalSolve : public ::testing::Test {
 protected:
  static constexpr double kError = sizeof(Scalar) == 8 ? 1e-12 : 1e-4;
  static Rows<Scalar> solved(SupernodalSolver<Scalar>& solver, Rows<Scalar> x, ThreadPool& pool) {
    solver.solve(x.data(), pool);
    return x;
  }
};
using Scalars = ::testing::Types<double, float>;
TYPED_TEST_SUITE(SupernodalSolve, Scalars, );  // clang wants the empty argument

TYPED_TEST(SupernodalSolve, AgreesWithADenseSolveToTheSameBitsForAnyNumberOfThreads) {
  for (const Factor& factor : factors()) {
    ThreadPool one(1);
    SupernodalSolver<TypeParam> alone(factor.pattern, factor.lower(), one);
    const Rows<TypeParam> right = support::random_points(factor.dense.rows(), 2).template cast<TypeParam>();
    const Rows<TypeParam> expected = this->solved(alone, right, one);
    const auto lower = factor.dense.triangularView<Eigen::Lower>();
    const Eigen::MatrixXd exact = lower.transpose().solve(lower.solve(Eigen::MatrixXd(right.template cast<double>())));
    EXPECT_LT((expected.template cast<double>() - exact).norm(), this->kError * exact.norm()) << factor.name;
    for (const int threads : {1, 2, 3}) {
      ThreadPool pool(threads);
      SupernodalSolver<TypeParam> solver(factor.pattern, factor.lower(), pool);
      for (int time = 0; time < 4; ++time) {
        ASSERT_TRUE(this->solved(solver, right, pool) == expected) << factor.name << ", " << threads << " threads";
        this->solved(solver, std::numeric_limits<TypeParam>::quiet_NaN() * right, pool);
      }
      ASSERT_TRUE(this->solved(solver, right, one) == expected)
          << factor.name << ": another pool than it was made with";
    }
  }
}

/// Fails if single precision keeps 1e-40 as a denormal number: it would come out again where there is nothing else.
TEST(SupernodalSolver, TinyEntriesAreNothingInSinglePrecision) {
  ThreadPool pool(1);
  for (Factor factor : factors()) {
    for (double& value : factor.dense.reshaped()) {
      value = value != 0 && std::abs(value) < 0.9 ? std::copysign(1e-40, value) : value;
    }
    const auto n = factor.dense.rows();
    const Eigen::VectorXd diagonal = factor.dense.diagonal();
    SupernodalSolver<float> solver(factor.pattern, factor.lower(), pool);
    for (const Eigen::Index pulled : {Eigen::Index(0), n / 2, n - 1}) {
      Rows<float> x = Rows<float>::Zero(n, 3);
      x.row(pulled) << 1, -1, 1e-3F;
      solver.solve(x.data(), pool);
      EXPECT_NEAR(x(pulled, 0) * diagonal[pulled] * diagonal[pulled], 1, 1e-5) << factor.name;
      for (Eigen::Index i = 0; i < 3 * n; ++i) {
        ASSERT_TRUE(x.data()[i] == 0 || std::isnormal(x.data()[i])) << factor.name << ": " << x.data()[i];
      }
    }
  }
}

TEST(SparseCholeskySingle, PrecisionNeedsOneStepOfRefinement) {
  const SparseMatrix lower = support::system_of(support::surface(support::Surface::Torus, 20, 25));
  const SparseMatrix matrix = lower.selfadjointView<Eigen::Lower>();
  CholeskyOptions options;
  options.single_precision = true;
  SparseCholesky factor(matrix, options);
  EXPECT_TRUE(factor.single_precision());
  const Points expected = support::random_points(matrix.rows(), 8), right = matrix * expected;
  Points x, step;
  factor.solve(right, x);
  EXPECT_LT((x - expected).norm(), 1e-5 * expected.norm());
  EXPECT_GT((x - expected).norm(), 1e-10 * expected.norm()) << "or it is not single precision";
  factor.solve(right - matrix * x, step);
  EXPECT_LT((x + step - expected).norm(), 1e-9 * expected.norm());
  for (const double scale : {std::ldexp(1.0, -200), std::ldexp(1.0, 200)}) {
    factor.solve(scale * right, step);
    EXPECT_TRUE(support::same_bits(step, scale * x)) << scale;
  }
}

}  // namespace
}  // namespace lapedit::supernodal_solve_test
