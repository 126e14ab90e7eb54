// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/linear/supernodal_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>
#ifdef LAPEDIT_HAVE_CHOLMOD
#include <cholmod.h>
#endif

#include "base_support.h"

namespace lapedit::supernodal_analysis_test {
namespace {

struct AnalysisCase {
  SparseMatrix matrix;
  std::vector<int> order;
};

/// Patterns of all kinds: nothing but the diagonal, forests, bands, meshes, dense rows; in any order.
std::vector<AnalysisCase> cases() {
  std::mt19937 random(15);
  std::vector<AnalysisCase> all;
  const auto add = [&](int n, const std::vector<std::pair<int, int>>& edges) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(n + 2 * edges.size());
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, i, 100);
    }
    for (const auto& [a, b] : edges) {
      if (a != b) {
        entries.emplace_back(a, b, -1), entries.emplace_back(b, a, -1);
      }
    }
    AnalysisCase made{SparseMatrix(n, n), std::vector<int>(n)};
    made.matrix.setFromTriplets(entries.begin(), entries.end());
    std::iota(made.order.begin(), made.order.end(), 0);
    all.push_back(made);
    made.order = support::shuffled(n, static_cast<unsigned>(random()));
    all.push_back(made);
  };
  const auto any = [&](int n) { return static_cast<int>(random() % n); };
  add(1, {});
  add(9, {});
  for (int round = 0; round < 40; ++round) {
    const int n = 2 + any(round < 20 ? 12 : 150), kind = round % 4, count = kind == 0 ? n / 2 : kind == 1 ? n : 3 * n;
    std::vector<std::pair<int, int>> edges;
    for (int e = 0; e < count; ++e) {
      const int a = any(n);
      edges.emplace_back(a, kind == 2 ? std::min(n - 1, a + any(6)) : any(n));
    }
    for (int v = 0; kind == 3 && v < n; ++v) {
      edges.emplace_back(n / 2, v);
    }
    add(n, edges);
  }
  std::vector<std::pair<int, int>> grid;
  constexpr int kWide = 30, kHigh = 21;
  for (int v = 0; v < kWide * kHigh; ++v) {
    if (v % kWide + 1 < kWide) grid.emplace_back(v, v + 1);
    if (v + kWide < kWide * kHigh) grid.emplace_back(v, v + kWide);
  }
  add(kWide * kHigh, grid);
  return all;
}

TEST(SupernodalAnalysis, MinimumDegreeFillsLittle) {
  const AnalysisCase grid = cases().back();
  const std::size_t shuffled = supernodal_analysis(grid.matrix, grid.order).factor_nonzeros();
  EXPECT_LT(supernodal_analysis(grid.matrix, {}).factor_nonzeros(), shuffled / 4);
}

#ifdef LAPEDIT_HAVE_CHOLMOD
/// The same supernodes and the same order as SuiteSparse finds: whose rules they are.
TEST(SupernodalAnalysis, FindsWhatCholmodFinds) {
  for (AnalysisCase& c : cases()) {
    const auto n = static_cast<int>(c.order.size());
    cholmod_common common;
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
    cholmod_sparse view{};
    view.nrow = view.ncol = static_cast<std::size_t>(n);
    view.nzmax = static_cast<std::size_t>(c.matrix.nonZeros());
    view.p = c.matrix.outerIndexPtr();
    view.i = c.matrix.innerIndexPtr();
    view.x = c.matrix.valuePtr();
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = view.packed = 1;
    cholmod_factor* factor = cholmod_analyze_p(&view, c.order.data(), nullptr, 0, &common);
    ASSERT_TRUE(factor && factor->is_super);
    const SupernodalPattern pattern = supernodal_analysis(c.matrix, c.order);
    const auto list = [](const void* values, std::size_t count) {
      return std::vector<int>(static_cast<const int*>(values), static_cast<const int*>(values) + count);
    };
    EXPECT_EQ(pattern.order, list(factor->Perm, factor->n));
    EXPECT_EQ(pattern.columns, list(factor->super, factor->nsuper + 1));
    EXPECT_EQ(pattern.row_offsets, list(factor->pi, factor->nsuper + 1));
    EXPECT_EQ(pattern.rows, list(factor->s, factor->ssize));
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
}
#endif

}  // namespace
}  // namespace lapedit::supernodal_analysis_test
