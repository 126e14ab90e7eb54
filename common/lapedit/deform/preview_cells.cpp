// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/preview_cells.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lapedit/base/cpu_dispatch.h"

namespace lapedit::preview {
namespace {

LAPEDIT_INLINE float sum_of(Four v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}

/// As BlendedRotations::spread(): columns of R - I.
LAPEDIT_INLINE void spread(const Follow* follow, const Four* quaternions, int first, int last, Four* turns) {
  constexpr float kCancelled = 0.2F;
  for (int place = first; place < last; ++place) {
    const Follow& f = follow[place];
    const Four towards = quaternions[f.cells[0]];
    Four q = {};
    for (int k = 0; k < CellBlend::kReach; ++k) {
      const Four one = quaternions[f.cells[k]];
      q += f.weights[k] * sum_of(one * towards) * one;
    }
    q += std::max(0.0F, kCancelled - std::sqrt(sum_of(q * q))) * towards;
    q *= 1 / std::sqrt(sum_of(q * q));
    const float along = f.hold * q[3];
    q *= 1 - f.hold;
    q[3] += along;
    const float squared = sum_of(q * q);
    q = squared > 0 ? q / std::sqrt(squared) : Four{0, 0, 0, 1};
    const float x = q[0], y = q[1], z = q[2], w = q[3];
    Four* const columns = turns + 4 * static_cast<std::ptrdiff_t>(place);
    columns[0] = Four{-2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0};
    columns[1] = Four{2 * (x * y - w * z), -2 * (x * x + z * z), 2 * (y * z + w * x), 0};
    columns[2] = Four{2 * (x * z + w * y), 2 * (y * z - w * x), -2 * (x * x + y * y), 0};
  }
}

LAPEDIT_INLINE Four turned(const Four* columns, Four edge) {
  return edge[0] * columns[0] + edge[1] * columns[1] + edge[2] * columns[2];
}

LAPEDIT_INLINE void turn_edges(const View& v, const float* rows, bool by_edges, const Four* turns, int first, int last,
                               Four* out) {
  for (int i = first; i < last; ++i) {
    const Four* const own = turns + 4 * static_cast<std::ptrdiff_t>(i);
    Four coordinate = {}, others = {};
    for (int k = v.offsets[i]; k < v.offsets[i + 1]; ++k) {
      const Four* const other = turns + 4 * static_cast<std::ptrdiff_t>(v.neighbours[k]);
      const Four edge = rows[k] * (other[3] - own[3]);
      coordinate += edge;
      others += turned(other, edge);
    }
    const Four whole = turned(own, coordinate);
    out[i] = by_edges ? 0.5F * (whole + others) : whole;
  }
}

struct CellKernels {
  void (*spread)(const Follow* follow, const Four* quaternions, int first, int last, Four* turns);
  void (*turn_edges)(const View& v, const float* rows, bool by_edges, const Four* turns, int first, int last,
                     Four* out);
};

// NOLINTBEGIN(bugprone-macro-parentheses): an attribute cannot stand in parentheses
#define LAPEDIT_CELL_KERNELS(suffix, attribute)                                                                     \
  attribute void spread_##suffix(const Follow* follow, const Four* quaternions, int first, int last, Four* turns) { \
    spread(follow, quaternions, first, last, turns);                                                                \
  }                                                                                                                 \
  attribute void turn_edges_##suffix(const View& v, const float* rows, bool by_edges, const Four* turns, int first, \
                                     int last, Four* out) {                                                         \
    turn_edges(v, rows, by_edges, turns, first, last, out);                                                         \
  }                                                                                                                 \
  constexpr CellKernels k_##suffix = {spread_##suffix, turn_edges_##suffix};
// NOLINTEND(bugprone-macro-parentheses)

#define LAPEDIT_NOTHING
LAPEDIT_CELL_KERNELS(plain, LAPEDIT_NOTHING)
#ifdef LAPEDIT_HAVE_AVX
LAPEDIT_CELL_KERNELS(avx2, LAPEDIT_AVX2)
#endif

/// For this processor.
CellKernels best_cell_kernels() {
#ifdef LAPEDIT_HAVE_AVX
  if (cpu_level() != CpuLevel::Plain) {
    return k_avx2;  // four numbers at a time: wider registers are of no use
  }
#endif
  return k_plain;
}

}  // namespace

CellTurns::CellTurns(const BlendedRotations& blended, const OperatorRows& first, bool by_edges, const Tables& tables)
    : tables_(tables),
      by_edges_(by_edges),
      follow_(tables.size),
      rows_(tables.neighbours.size()),
      turns_(static_cast<std::size_t>(tables.size)) {
  static_assert(sizeof(Line) == 4 * sizeof(Four));
  blended.quaternions(quaternions_);  // all memory from here on, whatever the first frame is
  cells_.resize(quaternions_.size());
  const std::vector<int> place_of = tables.places();
  const CellBlend& blend = blended.blend();
  for (int place = 0; place < tables.size; ++place) {
    const int i = tables.order[place];
    Follow& follow = follow_[place];
    for (int k = 0; k < CellBlend::kReach; ++k) {
      follow.cells[k] = blend.cells(k, i);
      follow.weights[k] = blend.weights(k, i);
    }
    follow.hold = static_cast<float>(blended.hold(i));
    Four& at = reinterpret_cast<Four*>(turns_.data())[4 * static_cast<std::ptrdiff_t>(place) + 3];
    for (int e = 0; e < 3; ++e) {
      at[e] = static_cast<float>((tables.world(place, e) - tables.world(0, e)) / tables.unit);
    }
    at[3] = 0;
    int to = tables.offsets[place];
    for (OperatorRows::Rows::InnerIterator entry(first.rows(), i); entry; ++entry) {
      if (entry.col() != i) {
        rows_[to++] = static_cast<float>(entry.value());
      }
    }
  }
}

std::size_t CellTurns::bytes() const {
  return follow_.capacity() * sizeof(Follow) + rows_.capacity() * sizeof(float) + turns_.capacity() * sizeof(Line);
}

void CellTurns::turn(const BlendedRotations& blended, Four* y, ThreadPool& pool) {
  const CellKernels kernels = best_cell_kernels();
  blended.quaternions(quaternions_);
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    for (int e = 0; e < 4; ++e) {
      cells_[c][e] = static_cast<float>(quaternions_[c][e]);
    }
  }
  Four* const turns = reinterpret_cast<Four*>(turns_.data());
  const auto in_places = [&](const auto& body) {
    in_pieces(pool, tables_.blocks, kGrain,
              [&](int first, int last) { body(first * kLanes, std::min(last * kLanes, tables_.size)); });
  };
  in_places([&](int first, int last) { kernels.spread(follow_.data(), cells_.data(), first, last, turns); });
  const View view = tables_.view();
  in_places([&](int first, int last) { kernels.turn_edges(view, rows_.data(), by_edges_, turns, first, last, y); });
}

}  // namespace lapedit::preview
