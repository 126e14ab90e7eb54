// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/matrix_averages.h"

#include <cstddef>
#include <cstring>

#include "lapedit/base/simd.h"

namespace lapedit {
namespace {

constexpr int kStride = 12;
using Lanes = Doubles4;

struct MeanAround {
  const CompressedRows& neighbours;
  const double* in;
  double* out;

  LAPEDIT_INLINE void operator()(int a) const {
    const double* from = in + std::ptrdiff_t{kStride} * a;
    Lanes sum[3] = {load<Lanes>(from), load<Lanes>(from + 4), load<Lanes>(from + 8)};
    for (const int b : neighbours[a]) {
      from = in + std::ptrdiff_t{kStride} * b;
      for (int e = 0; e < 3; ++e) {
        sum[e] += load<Lanes>(from + 4 * static_cast<std::ptrdiff_t>(e));
      }
    }
    const double factor = 1 / (1 + static_cast<double>(neighbours[a].size()));
    for (int e = 0; e < 3; ++e) {
      sum[e] *= factor;
    }
    std::memcpy(out + std::ptrdiff_t{kStride} * a, sum, sizeof sum);
  }
};

}  // namespace

void MatrixAverages::average(const CompressedRows& neighbours, int rounds, ThreadPool& pool) {
  constexpr int kGrain = 1024;
  const auto count = static_cast<int>(current_.size() / kStride);
  for (int round = 0; round < rounds; ++round) {
    current_.swap(other_);
    const MeanAround mean = {neighbours, other_.data(), current_.data()};  // not contracted: the same bits everywhere
    in_pieces(pool, count, kGrain, [&](int first, int last) { run_kernel(mean, first, last); });
  }
}

}  // namespace lapedit
