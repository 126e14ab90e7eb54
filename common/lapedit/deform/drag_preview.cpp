// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/drag_preview.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/preview_cells.h"
#include "lapedit/deform/preview_tables.h"

namespace lapedit {

using namespace preview;

namespace {

Four crossed(Four a, Four b) {
  const Four a1 = __builtin_shufflevector(a, a, 1, 2, 0, 3), b1 = __builtin_shufflevector(b, b, 1, 2, 0, 3);
  const Four c = a * b1 - a1 * b;
  return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

/// Twice the area times the normal, of the faces around a place.
Four ring_normal(const Tables& tables, const Four* points, int place) {
  Four sum = {};
  const Four here = points[place];
  for (int n = tables.ring_offsets[place]; n < tables.ring_offsets[place + 1]; n += 2) {
    sum += crossed(points[tables.ring[n]] - here, points[tables.ring[n + 1]] - here);
  }
  return sum;
}

/// Woodbury's correction by place, and what a frame works out with it.
struct PlacedCorrection {
  std::vector<int> rows;
  std::vector<double> weights;
  std::vector<float> z;  // by place, then column
  Eigen::MatrixXd k;
  Eigen::MatrixXd at_rows, update;

  PlacedCorrection(const WoodburyCorrection* given, const Tables& tables) {
    if (given == nullptr) {
      return;
    }
    const std::vector<int> place = tables.places();
    for (const int row : given->rows) {
      rows.push_back(place[row]);
    }
    weights = given->weights;
    k = given->k;
    at_rows.setZero(columns(), 3);
    update.setZero(columns(), 3);
    z.resize(static_cast<std::size_t>(tables.size) * rows.size());
    for (int i = 0; i < tables.size; ++i) {
      for (int c = 0; c < columns(); ++c) {
        z[static_cast<std::size_t>(i) * rows.size() + c] = static_cast<float>(given->z(tables.order[i], c));
      }
    }
  }
  int columns() const { return static_cast<int>(rows.size()); }

  /// W^-2 b_h, and b without b_h.
  void take(float* b) {
    for (int c = 0; c < columns(); ++c) {
      for (int e = 0; e < 3; ++e) {
        const std::size_t entry = 3 * static_cast<std::size_t>(rows[c]) + e;
        at_rows(c, e) = static_cast<double>(b[entry]) / weights[c];
        b[entry] = 0;
      }
    }
  }
  /// K (W^-2 b_h - y_h)
  void solve(const float* y) {
    for (int c = 0; c < columns(); ++c) {
      for (int e = 0; e < 3; ++e) {
        at_rows(c, e) -= static_cast<double>(y[3 * static_cast<std::size_t>(rows[c]) + e]);
      }
    }
    update.noalias() = k * at_rows;
  }
};

}  // namespace

struct DragPreview::Impl {
  Kernels kernels = best_kernels();
  SparseCholesky& factor;
  std::shared_ptr<ThreadPool> pool;
  Averaged averaged;
  Tables tables;
  PlacedCorrection correction;
  std::unique_ptr<CellTurns> cell_turns;  // or nothing

  // Of a frame.
  std::vector<int> which;     // responses that move
  std::vector<float> motion;  // three for each of them
  std::vector<Four> turned, smooth_after, after;
  std::vector<Line> smooth_normals;
  std::vector<char> hard;
  std::vector<float> x;
  Points positions, normals;

  Impl(const PreviewBase& base, const Eigen::MatrixXd& responses, const Eigen::MatrixXd& smooth_responses,
       SparseCholesky& used, std::shared_ptr<ThreadPool> given)
      : factor(used),
        pool(std::move(given)),
        averaged(base.smooth_rest != nullptr ? (base.region->size() + kLanes - 1) / kLanes : 0),
        tables(base, responses, smooth_responses, factor.order(), kernels, averaged, *pool),
        correction(base.correction, tables),
        turned(static_cast<std::size_t>(tables.blocks) * kLanes),
        smooth_after(tables.smooth_rest.size()),
        after(tables.size),
        smooth_normals(tables.smooth_rest.empty() ? 0 : 3 * static_cast<std::size_t>(tables.blocks)),
        hard(tables.blocks),
        x(3 * static_cast<std::size_t>(tables.size)),
        positions(tables.size, 3) {
    if (base.blended != nullptr) {
      cell_turns = std::make_unique<CellTurns>(*base.blended, *base.first, base.turns_edges, tables);
    }
    which.reserve(tables.responses);
    motion.reserve(3 * static_cast<std::size_t>(tables.responses));
  }

  /// Calls body(first, last) on the pool for pieces of the places.
  template <class Body>
  void for_places(const Body& body) {
    in_pieces(*pool, tables.blocks, kGrain,
              [&](int first, int last) { body(first * kLanes, std::min(last * kLanes, tables.size)); });
  }

  View view() const;
  void choose(const Points& motions);
  void smooth_normals_after();
  void turn_deltas();
  void apply_transposed();
  void turn_hard_ones(int first_block, int last_block);
  void place_all();
};

View DragPreview::Impl::view() const {
  View v = tables.view();
  v.active = static_cast<int>(which.size());
  v.which = which.data();
  v.motion = motion.data();
  v.normals = smooth_normals.data();
  return v;
}

/// The responses that move, and how, in units of the tables.
void DragPreview::Impl::choose(const Points& motions) {
  which.clear();
  motion.clear();
  for (int r = 0; r < tables.responses; ++r) {
    if (!motions.row(r).isZero(0)) {
      which.push_back(r);
      for (int e = 0; e < 3; ++e) {
        motion.push_back(static_cast<float>(motions(r, e) / tables.unit));
      }
    }
  }
}

/// P1 = P0 + sum_r u_r w_r and its normals: with several responses they are no longer linear in them.
void DragPreview::Impl::smooth_normals_after() {
  for_places([&](int first, int last) {
    for (int place = first; place < last; ++place) {
      Four sum = tables.smooth_rest[place];
      for (std::size_t a = 0; a < which.size(); ++a) {
        const float u = tables.smooth_responses[static_cast<std::size_t>(place) * tables.responses + which[a]];
        sum += u * Four{motion[3 * a], motion[3 * a + 1], motion[3 * a + 2], 0};
      }
      smooth_after[place] = sum;
    }
  });
  for_places([&](int first, int last) {
    for (int place = first; place < last; ++place) {
      const Four normal = ring_normal(tables, smooth_after.data(), place);
      for (int e = 0; e < 3; ++e) {
        lane_of(smooth_normals[3 * static_cast<std::size_t>(place / kLanes) + e].vector, place % kLanes) = normal[e];
      }
    }
  });
}

/// turned = (R - I) delta, R nearest to the averages of C + |C| n1 n0^T (see RotationEstimator).
void DragPreview::Impl::turn_deltas() {
  const View v = view();
  in_pieces(*pool, tables.blocks, kGrain,
            [&](int first, int last) { kernels.normal_terms(v, first, last, averaged.in()); });
  averaged.average(v, kernels, *pool, kAveragingPasses - 1);  // the last one comes with the turning
  auto* const result = reinterpret_cast<float*>(turned.data());
  in_pieces(*pool, tables.blocks, kGrain, [&](int first, int last) {
    kernels.turned_deltas(v, first, last, averaged.in(), averaged.out(), result, hard.data());
    turn_hard_ones(first, last);
  });
}

/// x = M^T turned, with its membrane.
void DragPreview::Impl::apply_transposed() {
  const View v = view();
  const auto* const y = reinterpret_cast<const float*>(turned.data());
  in_pieces(*pool, tables.blocks, kGrain,
            [&](int first, int last) { kernels.right_hand_side(v, first, last, y, x.data()); });
}

/// Those that single precision leaves too few digits, from the matrices that the kernel has left.
void DragPreview::Impl::turn_hard_ones(int first_block, int last_block) {
  for (int block = first_block; block < last_block; ++block) {
    for (int lane = 0; hard[block] && lane < kLanes && block * kLanes + lane < tables.size; ++lane) {
      const std::size_t place = static_cast<std::size_t>(block) * kLanes + lane;
      const float* const entries = averaged.out() + place * kStride;
      if (entries[9] == 0) {
        continue;
      }
      Matrix3 matrix;
      for (int e = 0; e < 9; ++e) {
        matrix(e / 3, e % 3) = static_cast<double>(entries[e]);
      }
      Vector3 delta;
      for (int e = 0; e < 3; ++e) {
        delta[e] = static_cast<double>(lane_of(tables.base[block].delta[e], lane));
      }
      // What is beyond single precision stays so, for the caller to see.
      const Vector3 difference = matrix.allFinite() ? Vector3(nearest_rotation(matrix) * delta - delta)
                                                    : Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
      for (int e = 0; e < 3; ++e) {
        turned[place][e] = static_cast<float>(difference[e]);
      }
    }
  }
}

/// p + unit (y + sum_r u_r w_r + Z K (W^-2 b_h - y_h)), y what x is now.
void DragPreview::Impl::place_all() {
  const int columns = correction.columns();
  correction.solve(x.data());
  for_places([&](int first, int last) {
    for (int place = first; place < last; ++place) {
      const float* const solved = x.data() + 3 * static_cast<std::size_t>(place);
      Eigen::RowVector3d way(static_cast<double>(solved[0]), static_cast<double>(solved[1]),
                             static_cast<double>(solved[2]));
      for (std::size_t a = 0; a < which.size(); ++a) {
        const ResponseBlock& part =
            tables.response[static_cast<std::size_t>(which[a]) * tables.blocks + place / kLanes];
        const auto u = static_cast<double>(reinterpret_cast<const float*>(&part.response)[place % kLanes]);
        for (int e = 0; e < 3; ++e) {
          way[e] += u * static_cast<double>(motion[3 * a + e]);
        }
      }
      for (int c = 0; c < columns; ++c) {
        const auto factor_c = static_cast<double>(correction.z[static_cast<std::size_t>(place) * columns + c]);
        for (int e = 0; e < 3; ++e) {
          way[e] += factor_c * correction.update(c, e);
        }
      }
      const Eigen::RowVector3d to = tables.world.row(place) + tables.unit * way;
      positions.row(tables.order[place]) = to;
      const Eigen::RowVector3d local = (to - tables.world.row(0)) / tables.unit;
      after[place] = Four{static_cast<float>(local[0]), static_cast<float>(local[1]), static_cast<float>(local[2]), 0};
    }
  });
}

DragPreview::DragPreview(const PreviewBase& base, const Eigen::MatrixXd& responses,
                         const Eigen::MatrixXd& smooth_responses, SparseCholesky& factor,
                         std::shared_ptr<ThreadPool> pool)
    : impl_(std::make_unique<Impl>(base, responses, smooth_responses, factor, std::move(pool))) {}

DragPreview::~DragPreview() = default;

const Points& DragPreview::pose(const Points& motions, const BlendedRotations* blended) {
  Impl& s = *impl_;
  s.choose(motions);
  if (s.which.empty() || !(s.tables.rotated || s.cell_turns)) {
    std::fill(s.x.begin(), s.x.end(), 0.0F);
    s.correction.at_rows.setZero();
    s.place_all();
    return s.positions;
  }
  if (s.cell_turns) {
    s.cell_turns->turn(*blended, s.turned.data(), *s.pool);
  } else {
    if (s.which.size() > 1) {
      s.smooth_normals_after();
    }
    s.turn_deltas();
  }
  s.apply_transposed();
  s.correction.take(s.x.data());
  s.factor.solve_in_order(s.x.data());
  s.place_all();
  return s.positions;
}

const Points& DragPreview::normals() {
  Impl& s = *impl_;
  s.normals.resize(s.tables.size, 3);
  s.for_places([&](int first, int last) {
    for (int place = first; place < last; ++place) {
      const int vertex = s.tables.order[place];
      const Four sum = ring_normal(s.tables, s.after.data(), place);
      const float squared = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
      if (!(squared > 0 && std::isfinite(squared))) {
        s.normals.row(vertex).setZero();
        continue;
      }
      const float scale = 1 / std::sqrt(squared);
      s.normals.row(vertex) << static_cast<double>(scale * sum[0]), static_cast<double>(scale * sum[1]),
          static_cast<double>(scale * sum[2]);
    }
  });
  return s.normals;
}

std::size_t DragPreview::bytes() const {
  const Impl& s = *impl_;
  const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return s.tables.bytes() + (s.cell_turns ? s.cell_turns->bytes() : 0) + of(s.averaged.current) + of(s.averaged.other) +
         of(s.correction.z) + of(s.turned) + of(s.smooth_after) + of(s.after) + of(s.smooth_normals) + of(s.x) +
         sizeof(double) * static_cast<std::size_t>(s.positions.size() + s.normals.size());
}

}  // namespace lapedit
