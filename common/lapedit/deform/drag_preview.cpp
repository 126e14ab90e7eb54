// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/drag_preview.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "lapedit/deform/detail_rotation.h"
#include "lapedit/deform/preview_kernels.h"

namespace lapedit {

using namespace preview;

namespace {

/// One lane of a vector.
float& lane_of(Vector& vector, int lane) {
  return reinterpret_cast<float*>(&vector)[lane];
}

}  // namespace

struct DragPreview::Inside {
  Kernels kernels = best_kernels();
  SparseCholesky& factor;
  std::shared_ptr<ThreadPool> pool;
  int size = 0, blocks = 0, responses = 0;

  std::vector<int> order;                // place -> local vertex
  std::vector<int> offsets, neighbours;  // by place
  std::vector<float> weights;
  std::vector<int> ring_offsets, ring;  // faces around a vertex: its two other corners each, in turn
  std::vector<Block> base;
  std::vector<ResponseBlock> response;
  std::vector<Four> smooth_rest;        // only for several responses
  std::vector<float> smooth_responses;  // by place, then response; likewise
  Points world;                         // by place
  std::vector<int> corrected_rows;      // places
  std::vector<double> corrected_weights;
  std::vector<float> z;  // by place, then column
  Eigen::MatrixXd update_matrix;
  double unit = 1;  // lengths in single precision are in this unit, so that their powers stay in range
  bool rotated = false;

  // Of a frame.
  std::vector<Line> first_buffer, second_buffer;
  std::vector<Four> turned, smooth_after, after;
  std::vector<Line> smooth_normals;
  std::vector<float> x;
  std::vector<char> hard;
  std::vector<int> which;
  std::vector<float> motion;
  Eigen::MatrixXd at_rows, update;
  Points positions, normals;

  Inside(SparseCholesky& used, std::shared_ptr<ThreadPool> given) : factor(used), pool(std::move(given)) {}

  void order_all(const PreviewBase& given);
  void make_tables(const PreviewBase& given, const Eigen::MatrixXd& smooth_given);
  View view() const;
  float* first() { return reinterpret_cast<float*>(first_buffer.data()); }
  float* second() { return reinterpret_cast<float*>(second_buffer.data()); }
  void average_times(const View& v, int passes);
  void smooth_normals_after();
  void turn_hard_ones(int first_block, int last_block);
  void place_all();
};

View DragPreview::Inside::view() const {
  View v{};
  v.size = size;
  v.blocks = blocks;
  v.responses = responses;
  v.base = base.data();
  v.response = response.data();
  v.offsets = offsets.data();
  v.neighbours = neighbours.data();
  v.weights = weights.data();
  v.active = static_cast<int>(which.size());
  v.which = which.data();
  v.motion = motion.data();
  v.normals = smooth_normals.data();
  return v;
}

/// Neighbours, entries of M^T and faces around a vertex, all in the order of elimination.
void DragPreview::Inside::order_all(const PreviewBase& given) {
  const Region& region = *given.region;
  order = factor.order();
  size = region.size();
  blocks = (size + kLanes - 1) / kLanes;
  std::vector<int> place(size);
  for (int k = 0; k < size; ++k) {
    place[order[k]] = k;
  }
  offsets.resize(size + 1);
  ring_offsets.assign(size + 1, 0);
  offsets[0] = 0;
  for (int k = 0; k < size; ++k) {
    offsets[k + 1] = offsets[k] + region.neighbours[order[k]].size();
  }
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    for (int c = 0; c < 3; ++c) {
      ring_offsets[place[region.faces(f, c)] + 1] += 2;
    }
  }
  for (int k = 0; k < size; ++k) {
    ring_offsets[k + 1] += ring_offsets[k];
  }
  ring.resize(ring_offsets[size]);
  std::vector<int> filled(ring_offsets.begin(), ring_offsets.end() - 1);
  for (Eigen::Index f = 0; f < region.faces.rows(); ++f) {
    const int corner[3] = {place[region.faces(f, 0)], place[region.faces(f, 1)], place[region.faces(f, 2)]};
    for (int c = 0; c < 3; ++c) {
      int& to = filled[corner[c]];
      ring[to++] = corner[(c + 1) % 3];
      ring[to++] = corner[(c + 2) % 3];
    }
  }
  neighbours.resize(offsets[size]);
  weights.resize(offsets[size]);
  world.resize(size, 3);
  const SparseMatrix& m = given.first->matrix();
  in_pieces(*pool, blocks, kGrain, [&](int first, int last) {
    for (int k = first * kLanes; k < std::min(last * kLanes, size); ++k) {
      const int i = order[k];
      world.row(k) = given.world->row(i);
      int to = offsets[k];
      for (SparseMatrix::InnerIterator entry(m, i); entry; ++entry) {
        if (entry.row() != i) {
          neighbours[to] = place[entry.row()];
          weights[to++] = static_cast<float>(entry.value());
        }
      }
    }
  });
}

void DragPreview::Inside::average_times(const View& v, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    in_pieces(*pool, blocks, kGrain, [&](int begin, int end) { kernels.average(v, begin, end, first(), second()); });
    first_buffer.swap(second_buffer);
  }
}

void DragPreview::Inside::make_tables(const PreviewBase& given, const Eigen::MatrixXd& smooth_given) {
  const Region& region = *given.region;
  const Points p = *given.smooth_rest / unit;
  base.resize(blocks);
  first_buffer.assign(static_cast<std::size_t>(blocks) * kLanes, Line{});
  second_buffer = first_buffer;
  const View v = view();
  // What is to be averaged goes through five vectors of three at a time; the rest surface's covariance is two of them.
  const int batches = (2 + responses + 4) / 5;
  for (int batch = 0; batch < batches; ++batch) {
    in_pieces(*pool, blocks, kGrain, [&](int first_block, int last_block) {
      for (int place = first_block * kLanes; place < std::min(last_block * kLanes, size); ++place) {
        const int i = order[place];
        Block& block = base[place / kLanes];
        const int lane = place % kLanes;
        Matrix3 covariance = Matrix3::Zero();
        Eigen::Matrix<double, 3, kMostResponses> g = Eigen::Matrix<double, 3, kMostResponses>::Zero();
        for (int n = offsets[place]; n < offsets[place + 1]; ++n) {
          const int j = order[neighbours[n]];
          const Vector3 edge = (p.row(j) - p.row(i)).transpose();
          covariance.noalias() += edge * edge.transpose();
          for (int r = 0; r < responses; ++r) {
            g.col(r) += (smooth_given(j, r) - smooth_given(i, r)) * edge;
          }
        }
        float* const to = first() + static_cast<std::size_t>(place) * kStride;
        const double entries[6] = {covariance(0, 0), covariance(0, 1), covariance(0, 2),
                                   covariance(1, 1), covariance(1, 2), covariance(2, 2)};
        for (int e = 0; e < 15; ++e) {
          const int column = 5 * batch + e / 3 - 2;
          to[e] = static_cast<float>(column < 0           ? entries[3 * (5 * batch) + e]
                                     : column < responses ? g(e % 3, column)
                                                          : 0);
        }
        if (batch > 0) {
          continue;
        }
        for (int e = 0; e < 6; ++e) {
          lane_of(block.covariance[e], lane) = static_cast<float>(entries[e]);
        }
        Vector3 area = Vector3::Zero();
        Eigen::Matrix<double, 3, kMostResponses> b = Eigen::Matrix<double, 3, kMostResponses>::Zero();
        for (int n = ring_offsets[place]; n < ring_offsets[place + 1]; n += 2) {
          const int j = order[ring[n]], l = order[ring[n + 1]];
          const Vector3 to_j = (p.row(j) - p.row(i)).transpose(), to_l = (p.row(l) - p.row(i)).transpose();
          area += to_j.cross(to_l);
          for (int r = 0; r < responses; ++r) {
            b.col(r) +=
                (smooth_given(l, r) - smooth_given(i, r)) * to_j - (smooth_given(j, r) - smooth_given(i, r)) * to_l;
          }
        }
        const double length = area.norm();
        const double depth = region.anchor_depth.empty() ? 0 : region.anchor_depth[i];
        for (int e = 0; e < 3; ++e) {
          lane_of(block.area_normal[e], lane) = static_cast<float>(area[e]);
          lane_of(block.normal[e], lane) = static_cast<float>(length > 0 ? area[e] / length : 0);
          lane_of(block.delta[e], lane) = static_cast<float>((*given.delta)(i, e) / unit);
        }
        lane_of(block.hold, lane) = static_cast<float>(depth * depth * (3 - 2 * depth));
        for (int r = 0; r < responses; ++r) {
          ResponseBlock& part = response[static_cast<std::size_t>(r) * blocks + place / kLanes];
          for (int e = 0; e < 3; ++e) {
            lane_of(part.covariance[e], lane) = static_cast<float>(g(e, r));
            lane_of(part.normal[e], lane) = static_cast<float>(b(e, r));
          }
        }
      }
    });
    average_times(v, kAveragingPasses);
    in_pieces(*pool, blocks, kGrain, [&](int first_block, int last_block) {
      for (int place = first_block * kLanes; place < std::min(last_block * kLanes, size); ++place) {
        const float* const from = first() + static_cast<std::size_t>(place) * kStride;
        for (int e = 0; e < 15; ++e) {
          const int column = 5 * batch + e / 3 - 2;
          if (column < 0) {
            lane_of(base[place / kLanes].spread[e], place % kLanes) = from[e];
          } else if (column < responses) {
            lane_of(response[static_cast<std::size_t>(column) * blocks + place / kLanes].spread[e % 3],
                    place % kLanes) = from[e];
          }
        }
      }
    });
  }
  if (responses > 1) {
    smooth_rest.resize(size);
    smooth_responses.resize(static_cast<std::size_t>(size) * responses);
    smooth_after.resize(size);
    smooth_normals.resize(3 * static_cast<std::size_t>(blocks));
    for (int place = 0; place < size; ++place) {
      const int i = order[place];
      smooth_rest[place] =
          Four{static_cast<float>(p(i, 0) - p(order[0], 0)), static_cast<float>(p(i, 1) - p(order[0], 1)),
               static_cast<float>(p(i, 2) - p(order[0], 2)), 0};
      for (int r = 0; r < responses; ++r) {
        smooth_responses[static_cast<std::size_t>(place) * responses + r] = static_cast<float>(smooth_given(i, r));
      }
    }
  }
}

namespace {

Four crossed(Four a, Four b) {
  const Four a1 = __builtin_shufflevector(a, a, 1, 2, 0, 3), b1 = __builtin_shufflevector(b, b, 1, 2, 0, 3);
  const Four c = a * b1 - a1 * b;
  return __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

/// Twice the area times the normal, of the faces around a place.
Four ring_normal(const std::vector<int>& offsets, const std::vector<int>& ring, const Four* points, int place) {
  Four sum = {};
  const Four here = points[place];
  for (int n = offsets[place]; n < offsets[place + 1]; n += 2) {
    sum += crossed(points[ring[n]] - here, points[ring[n + 1]] - here);
  }
  return sum;
}

}  // namespace

/// With several responses normals are no longer linear in them: the smoothed surface is made and looked at.
void DragPreview::Inside::smooth_normals_after() {
  in_pieces(*pool, blocks, kGrain, [&](int first_block, int last_block) {
    for (int place = first_block * kLanes; place < std::min(last_block * kLanes, size); ++place) {
      Four sum = smooth_rest[place];
      for (std::size_t a = 0; a < which.size(); ++a) {
        const float u = smooth_responses[static_cast<std::size_t>(place) * responses + which[a]];
        sum += u * Four{motion[3 * a], motion[3 * a + 1], motion[3 * a + 2], 0};
      }
      smooth_after[place] = sum;
    }
  });
  in_pieces(*pool, blocks, kGrain, [&](int first_block, int last_block) {
    for (int place = first_block * kLanes; place < std::min(last_block * kLanes, size); ++place) {
      const Four normal = ring_normal(ring_offsets, ring, smooth_after.data(), place);
      for (int e = 0; e < 3; ++e) {
        lane_of(smooth_normals[3 * static_cast<std::size_t>(place / kLanes) + e].vector, place % kLanes) = normal[e];
      }
    }
  });
}

void DragPreview::Inside::turn_hard_ones(int first_block, int last_block) {
  for (int block = first_block; block < last_block; ++block) {
    for (int lane = 0; hard[block] && lane < kLanes && block * kLanes + lane < size; ++lane) {
      const std::size_t place = static_cast<std::size_t>(block) * kLanes + lane;
      const float* const entries = second() + place * kStride;
      if (entries[9] == 0) {
        continue;
      }
      Matrix3 matrix;
      for (int e = 0; e < 9; ++e) {
        matrix(e / 3, e % 3) = static_cast<double>(entries[e]);
      }
      Vector3 delta;
      for (int e = 0; e < 3; ++e) {
        delta[e] = static_cast<double>(lane_of(base[block].delta[e], lane));
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

void DragPreview::Inside::place_all() {
  const int columns = static_cast<int>(corrected_rows.size());
  for (int c = 0; c < columns; ++c) {
    for (int e = 0; e < 3; ++e) {
      at_rows(c, e) -= static_cast<double>(x[3 * static_cast<std::size_t>(corrected_rows[c]) + e]);
    }
  }
  update.noalias() = update_matrix * at_rows;
  in_pieces(*pool, blocks, kGrain, [&](int first_block, int last_block) {
    for (int place = first_block * kLanes; place < std::min(last_block * kLanes, size); ++place) {
      const float* const solved = x.data() + 3 * static_cast<std::size_t>(place);
      Eigen::RowVector3d way(static_cast<double>(solved[0]), static_cast<double>(solved[1]),
                             static_cast<double>(solved[2]));
      for (std::size_t a = 0; a < which.size(); ++a) {
        const ResponseBlock& part = response[static_cast<std::size_t>(which[a]) * blocks + place / kLanes];
        const auto u = static_cast<double>(reinterpret_cast<const float*>(&part.response)[place % kLanes]);
        for (int e = 0; e < 3; ++e) {
          way[e] += u * static_cast<double>(motion[3 * a + e]);
        }
      }
      for (int c = 0; c < columns; ++c) {
        const auto factor_c = static_cast<double>(z[static_cast<std::size_t>(place) * columns + c]);
        for (int e = 0; e < 3; ++e) {
          way[e] += factor_c * update(c, e);
        }
      }
      const Eigen::RowVector3d to = world.row(place) + unit * way;
      positions.row(order[place]) = to;
      const Eigen::RowVector3d local = (to - world.row(0)) / unit;
      after[place] = Four{static_cast<float>(local[0]), static_cast<float>(local[1]), static_cast<float>(local[2]), 0};
    }
  });
}

DragPreview::DragPreview(const PreviewBase& base, const Eigen::MatrixXd& responses,
                         const Eigen::MatrixXd& smooth_responses, const Correction& correction, SparseCholesky& factor,
                         std::shared_ptr<ThreadPool> pool)
    : inside_(std::make_unique<Inside>(factor, std::move(pool))) {
  Inside& s = *inside_;
  const double length = base.region->max_distance;
  s.unit = length > 0 && std::isfinite(length) ? std::ldexp(1.0, std::ilogb(length)) : 1;
  s.rotated = base.smooth_rest != nullptr;
  s.order_all(base);
  s.responses = static_cast<int>(responses.cols());
  s.response.resize(static_cast<std::size_t>(s.blocks) * s.responses);
  for (int k = 0; k < s.size; ++k) {
    for (int r = 0; r < s.responses; ++r) {
      lane_of(s.response[static_cast<std::size_t>(r) * s.blocks + k / kLanes].response, k % kLanes) =
          static_cast<float>(responses(s.order[k], r));
    }
  }
  if (s.rotated) {
    s.make_tables(base, smooth_responses);
  }
  const int columns = static_cast<int>(correction.rows.size());
  std::vector<int> place(s.size);
  for (int k = 0; k < s.size; ++k) {
    place[s.order[k]] = k;
  }
  for (const int row : correction.rows) {
    s.corrected_rows.push_back(place[row]);
  }
  s.z.resize(static_cast<std::size_t>(s.size) * columns);
  for (int k = 0; k < s.size; ++k) {
    for (int c = 0; c < columns; ++c) {
      s.z[static_cast<std::size_t>(k) * columns + c] = static_cast<float>(correction.z(s.order[k], c));
    }
  }
  s.update_matrix = correction.k;
  s.corrected_weights = correction.weights;
  s.at_rows.setZero(columns, 3);
  s.update.setZero(columns, 3);
  s.turned.assign(static_cast<std::size_t>(s.blocks) * kLanes, Four{});
  s.after.assign(s.size, Four{});
  s.x.assign(3 * static_cast<std::size_t>(s.size), 0);
  s.hard.assign(s.blocks, 0);
  s.which.reserve(s.responses);
  s.motion.reserve(3 * static_cast<std::size_t>(s.responses));
  s.positions.resize(s.size, 3);
}

DragPreview::~DragPreview() = default;

const Points& DragPreview::pose(const Points& motions) {
  Inside& s = *inside_;
  s.which.clear();
  s.motion.clear();
  for (int r = 0; r < s.responses; ++r) {
    if (!motions.row(r).isZero(0)) {
      s.which.push_back(r);
      for (int e = 0; e < 3; ++e) {
        s.motion.push_back(static_cast<float>(motions(r, e) / s.unit));
      }
    }
  }
  if (s.which.empty() || !s.rotated) {
    std::fill(s.x.begin(), s.x.end(), 0.0F);
    s.at_rows.setZero();
    s.place_all();
    return s.positions;
  }
  if (s.which.size() > 1) {
    s.smooth_normals_after();
  }
  const View v = s.view();
  in_pieces(*s.pool, s.blocks, kGrain, [&](int first, int last) { s.kernels.normal_terms(v, first, last, s.first()); });
  s.average_times(v, kAveragingPasses - 1);  // the last one comes with the turning
  auto* const turned = reinterpret_cast<float*>(s.turned.data());
  in_pieces(*s.pool, s.blocks, kGrain, [&](int first, int last) {
    s.kernels.turned_deltas(v, first, last, s.first(), s.second(), turned, s.hard.data());
    s.turn_hard_ones(first, last);
  });
  in_pieces(*s.pool, s.blocks, kGrain,
            [&](int first, int last) { s.kernels.right_hand_side(v, first, last, turned, s.x.data()); });
  for (std::size_t c = 0; c < s.corrected_rows.size(); ++c) {
    for (int e = 0; e < 3; ++e) {
      float& entry = s.x[3 * static_cast<std::size_t>(s.corrected_rows[c]) + e];
      s.at_rows(static_cast<Eigen::Index>(c), e) = static_cast<double>(entry) / s.corrected_weights[c];
      entry = 0;
    }
  }
  s.factor.solve_in_order(s.x.data());
  s.place_all();
  return s.positions;
}

const Points& DragPreview::normals() {
  Inside& s = *inside_;
  s.normals.resize(s.size, 3);
  in_pieces(*s.pool, s.blocks, kGrain, [&](int first_block, int last_block) {
    for (int place = first_block * kLanes; place < std::min(last_block * kLanes, s.size); ++place) {
      const Four sum = ring_normal(s.ring_offsets, s.ring, s.after.data(), place);
      const float squared = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
      if (!(squared > 0 && std::isfinite(squared))) {
        s.normals.row(s.order[place]).setZero();
        continue;
      }
      const float scale = 1 / std::sqrt(squared);
      s.normals.row(s.order[place]) << static_cast<double>(scale * sum[0]), static_cast<double>(scale * sum[1]),
          static_cast<double>(scale * sum[2]);
    }
  });
  return s.normals;
}

std::size_t DragPreview::bytes() const {
  const Inside& s = *inside_;
  const auto of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return of(s.order) + of(s.offsets) + of(s.neighbours) + of(s.weights) + of(s.ring_offsets) + of(s.ring) + of(s.base) +
         of(s.response) + of(s.smooth_rest) + of(s.smooth_responses) + of(s.z) + of(s.first_buffer) +
         of(s.second_buffer) + of(s.turned) + of(s.smooth_after) + of(s.after) + of(s.smooth_normals) + of(s.x) +
         3 * sizeof(double) * static_cast<std::size_t>(s.world.rows() + s.positions.rows() + s.normals.rows());
}

}  // namespace lapedit
