// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/matrix_averages.h"

#include <cstddef>
#include <cstring>

#include "lapedit/base/simd.h"

namespace lapedit {
namespace {

constexpr int kStride = 12;
using Lanes = Doubles4;

LAPEDIT_INLINE void mean_around(const IndexLists& neighbours, int first, int last, const double* in, double* out) {
  for (int a = first; a < last; ++a) {
    const double* from = in + std::ptrdiff_t{kStride} * a;
    Lanes sum[3] = {load<Lanes>(from), load<Lanes>(from + 4), load<Lanes>(from + 8)};
    for (const int b : neighbours[a]) {
      from = in + std::ptrdiff_t{kStride} * b;
      for (int e = 0; e < 3; ++e) {
        sum[e] += load<Lanes>(from + 4 * static_cast<std::ptrdiff_t>(e));
      }
    }
    const double share = 1 / (1 + static_cast<double>(neighbours[a].size()));
    for (int e = 0; e < 3; ++e) {
      sum[e] *= share;
    }
    std::memcpy(out + std::ptrdiff_t{kStride} * a, sum, sizeof sum);
  }
}

void mean_around_plain(const IndexLists& neighbours, int first, int last, const double* in, double* out) {
  mean_around(neighbours, first, last, in, out);
}
LAPEDIT_AVX2 void mean_around_avx2(const IndexLists& neighbours, int first, int last, const double* in, double* out) {
  mean_around(neighbours, first, last, in, out);
}

}  // namespace

void MatrixAverages::average(const IndexLists& neighbours, int rounds, ThreadPool& pool) {
  constexpr int kGrain = 1024;
  // The bits are the same, since sums are not contracted.
  const auto mean = for_processor(mean_around_plain, mean_around_avx2, mean_around_avx2);
  const auto count = static_cast<int>(current_.size() / kStride);
  for (int round = 0; round < rounds; ++round) {
    current_.swap(other_);
    in_pieces(pool, count, kGrain,
              [&](int first, int last) { mean(neighbours, first, last, other_.data(), current_.data()); });
  }
}

}  // namespace lapedit
