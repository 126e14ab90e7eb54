// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/drag_preview.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "lapedit/detail_rotation.h"
#include "lapedit/instructions.h"

namespace lapedit {
namespace {

constexpr int kLanes = 16;   // vertices worked on together
constexpr int kStride = 16;  // floats per vertex where matrices wait to be averaged: a cache line
constexpr int kGrain = 32;   // blocks of kLanes vertices per piece

typedef float Vector __attribute__((vector_size(kLanes * sizeof(float))));
typedef float Half __attribute__((vector_size(kLanes / 2 * sizeof(float))));
typedef int IntVector __attribute__((vector_size(kLanes * sizeof(int))));
typedef float Four __attribute__((vector_size(4 * sizeof(float))));

// What is kept in memory is aligned by name: left to itself, the alignment of a vector depends on the instructions that
// a function is compiled for.

/// Constants of sixteen vertices.
struct alignas(64) Block {
  Vector covariance[6];   // C0, symmetric: xx xy xz yy yz zz
  Vector spread[6];       // the same averaged
  Vector area_normal[3];  // a0
  Vector normal[3];       // unit normal of the smoothed rest surface
  Vector delta[3];
  Vector hold;  // how far a rotation is held back, 0 to 1
};

struct alignas(64) ResponseBlock {
  Vector covariance[3];  // g
  Vector spread[3];      // g averaged
  Vector normal[3];      // b
  Vector response;       // u
};

struct alignas(64) Line {
  Vector vector;
};
static_assert(alignof(Block) == 64 && alignof(ResponseBlock) == 64 && sizeof(Line) == 64);

/// What the kernels see.
struct View {
  int size, blocks, responses;
  const Block* base;
  const ResponseBlock* response;  // response k of block b at k * blocks + b
  const int* offsets;             // neighbours, in the order of elimination
  const int* neighbours;
  const float* weights;  // entries of M^T for them
  int active;            // responses that move
  const int* which;
  const float* motion;  // three per active response
  const Line* normals;  // three per block, smoothed surface after; only if several responses move
};

LAPEDIT_INLINE Vector inverse_root(Vector x) {
  IntVector bits;
  std::memcpy(&bits, &x, sizeof bits);
  bits = 0x5f3759df - (bits >> 1);
  Vector y;
  std::memcpy(&y, &bits, sizeof y);
  const Vector half = 0.5F * x;
  for (int step = 0; step < 3; ++step) {
    y = y * (1.5F - half * y * y);
  }
  return y;
}

LAPEDIT_INLINE Vector load(const float* place) {
  Vector result;
  std::memcpy(&result, place, sizeof result);
  return result;
}

/// |C| n1 n0^T of some blocks.
LAPEDIT_INLINE void normal_terms(const View& v, int first, int last, float* out) {
  for (int block = first; block < last; ++block) {
    const Block& base = v.base[block];
    Vector c[9] = {base.covariance[0], base.covariance[1], base.covariance[2], base.covariance[1], base.covariance[3],
                   base.covariance[4], base.covariance[2], base.covariance[4], base.covariance[5]};
    Vector n[3] = {base.area_normal[0], base.area_normal[1], base.area_normal[2]};
    for (int a = 0; a < v.active; ++a) {
      const ResponseBlock& r = v.response[static_cast<std::size_t>(v.which[a]) * v.blocks + block];
      const float* const w = v.motion + std::ptrdiff_t{3} * a;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          c[3 * i + j] += w[i] * r.covariance[j];
        }
      }
      if (v.active == 1) {
        n[0] += r.normal[1] * w[2] - r.normal[2] * w[1];
        n[1] += r.normal[2] * w[0] - r.normal[0] * w[2];
        n[2] += r.normal[0] * w[1] - r.normal[1] * w[0];
      }
    }
    Vector size = {};
    for (int e = 0; e < 9; ++e) {
      size += c[e] * c[e];
    }
    if (v.active > 1) {
      for (int i = 0; i < 3; ++i) {
        n[i] = v.normals[3 * block + i].vector;
      }
    }
    const Vector scale = size * inverse_root(size) * inverse_root(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    alignas(64) float rows[9][kLanes];
    for (int i = 0; i < 3; ++i) {
      const Vector row = scale * n[i];
      for (int j = 0; j < 3; ++j) {
        const Vector entry = row * base.normal[j];
        std::memcpy(rows[3 * i + j], &entry, sizeof entry);
      }
    }
    float* to = out + static_cast<std::size_t>(block) * kLanes * kStride;
    for (int lane = 0; lane < kLanes; ++lane, to += kStride) {
      for (int e = 0; e < 9; ++e) {
        to[e] = rows[e][lane];
      }
    }
  }
}

/// Mean over a vertex and its neighbours. In two halves, as AVX2 has registers for.
LAPEDIT_INLINE void mean_around(const View& v, int i, const float* in, float* out) {
  Half low, high;
  const float* at = in + static_cast<std::size_t>(i) * kStride;
  std::memcpy(&low, at, sizeof low);
  std::memcpy(&high, at + kStride / 2, sizeof high);
  const int begin = v.offsets[i], end = v.offsets[i + 1];
  for (int k = begin; k < end; ++k) {
    Half other_low, other_high;
    at = in + static_cast<std::size_t>(v.neighbours[k]) * kStride;
    std::memcpy(&other_low, at, sizeof other_low);
    std::memcpy(&other_high, at + kStride / 2, sizeof other_high);
    low += other_low;
    high += other_high;
  }
  const float share = 1.0F / static_cast<float>(1 + end - begin);
  low *= share;
  high *= share;
  std::memcpy(out, &low, sizeof low);
  std::memcpy(out + kStride / 2, &high, sizeof high);
}

LAPEDIT_INLINE void average(const View& v, int first, int last, const float* in, float* out) {
  const int end = std::min(last * kLanes, v.size);
  for (int i = first * kLanes; i < end; ++i) {
    mean_around(v, i, in, out + static_cast<std::size_t>(i) * kStride);
  }
}

/// (R - I) delta of some blocks, R the rotation nearest to a matrix by Markley's formula (FOAM, 1993), which is exact
/// and needs the largest root of a quartic only. Vertices that it leaves too few digits are listed in `hard`, for the
/// caller to do over with the matrices left in `matrices`.
LAPEDIT_INLINE void turned_deltas(const View& v, int first, int last, const float* in, float* matrices, float* out,
                                  char* hard) {
  for (int block = first; block < last; ++block) {
    const Block& base = v.base[block];
    alignas(64) float around[kLanes][kStride];
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = block * kLanes + lane;
      if (i < v.size) {
        mean_around(v, i, in, around[lane]);
      } else {
        std::memset(around[lane], 0, sizeof around[lane]);
      }
    }
    alignas(64) float columns[9][kLanes];
    for (int e = 0; e < 9; ++e) {
      for (int lane = 0; lane < kLanes; ++lane) {
        columns[e][lane] = around[lane][e];
      }
    }
    const Vector* const s = base.spread;
    Vector b[9] = {s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]};
    for (int e = 0; e < 9; ++e) {
      b[e] += load(columns[e]);
    }
    for (int a = 0; a < v.active; ++a) {
      const ResponseBlock& r = v.response[static_cast<std::size_t>(v.which[a]) * v.blocks + block];
      const float* const w = v.motion + std::ptrdiff_t{3} * a;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          b[3 * i + j] += w[i] * r.spread[j];
        }
      }
    }
    // Scaled to length 1, faded to the identity, and scaled again.
    Vector size = {};
    for (int e = 0; e < 9; ++e) {
      size += b[e] * b[e];
    }
    const Vector part = (1.0F - base.hold) * inverse_root(size);
    size = Vector{};
    for (int e = 0; e < 9; ++e) {
      b[e] = part * b[e] + (e % 4 == 0 ? base.hold : Vector{});
      size += b[e] * b[e];
    }
    const Vector unit = inverse_root(size);
    for (int e = 0; e < 9; ++e) {
      b[e] *= unit;
    }
    Vector f[9];  // cofactors
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        f[3 * i + j] = b[3 * i1 + j1] * b[3 * i2 + j2] - b[3 * i1 + j2] * b[3 * i2 + j1];
      }
    }
    const Vector det = b[0] * f[0] + b[1] * f[1] + b[2] * f[2];
    Vector squares = {};
    for (int e = 0; e < 9; ++e) {
      squares += f[e] * f[e];
    }
    Vector root = Vector{} + 1.7320509F;  // an upper bound, so Newton's steps come down to the largest root
    for (int step = 0; step < 7; ++step) {
      const Vector k = root * root - 1.0F;
      root -= (k * k - 8.0F * root * det - 4.0F * squares) / (4.0F * root * k - 8.0F * det + 1e-12F);
    }
    const Vector kappa = 0.5F * (root * root - 1.0F);
    const Vector zeta = kappa * root - det;
    const Vector inverse = 1.0F / zeta;
    Vector turned[3];
    Vector gram[9];  // B B^T
    for (std::ptrdiff_t i = 0; i < 3; ++i) {
      for (std::ptrdiff_t j = 0; j < 3; ++j) {
        gram[3 * i + j] = b[3 * i] * b[3 * j] + b[3 * i + 1] * b[3 * j + 1] + b[3 * i + 2] * b[3 * j + 2];
      }
    }
    // B delta and B B^T B delta, without making the product of the matrices.
    Vector once[3];
    for (std::ptrdiff_t i = 0; i < 3; ++i) {
      once[i] = b[3 * i] * base.delta[0] + b[3 * i + 1] * base.delta[1] + b[3 * i + 2] * base.delta[2];
    }
    for (std::ptrdiff_t i = 0; i < 3; ++i) {
      const Vector thrice = gram[3 * i] * once[0] + gram[3 * i + 1] * once[1] + gram[3 * i + 2] * once[2];
      const Vector cofactors = f[3 * i] * base.delta[0] + f[3 * i + 1] * base.delta[1] + f[3 * i + 2] * base.delta[2];
      turned[i] = ((kappa + 1.0F) * once[i] + root * cofactors - thrice) * inverse - base.delta[i];
    }
    alignas(64) float result[3][kLanes];
    for (int i = 0; i < 3; ++i) {
      std::memcpy(result[i], &turned[i], sizeof turned[i]);
    }
    alignas(64) float digits[kLanes];
    std::memcpy(digits, &zeta, sizeof zeta);
    float* to = out + static_cast<std::size_t>(block) * kLanes * 4;
    bool any = false;
    for (int lane = 0; lane < kLanes; ++lane, to += 4) {
      to[0] = result[0][lane];
      to[1] = result[1][lane];
      to[2] = result[2][lane];
      to[3] = 0;
      any = any || !(digits[lane] > 0.02F);
    }
    hard[block] = any;
    if (any) {
      alignas(64) float entries[9][kLanes];
      std::memcpy(entries, b, sizeof entries);
      for (int lane = 0; lane < kLanes && block * kLanes + lane < v.size; ++lane) {
        float* const kept = matrices + (static_cast<std::size_t>(block) * kLanes + lane) * kStride;
        for (int e = 0; e < 9; ++e) {
          kept[e] = entries[e][lane];
        }
        kept[9] = digits[lane] > 0.02F ? 0.0F : 1.0F;
      }
    }
  }
}

/// x = M^T y.
LAPEDIT_INLINE void right_hand_side(const View& v, int first, int last, const float* y, float* x) {
  const int end = std::min(last * kLanes, v.size);
  for (int i = first * kLanes; i < end; ++i) {
    Four sum = {};
    if (v.offsets[i] < v.offsets[i + 1]) {
      std::memcpy(&sum, y + 4 * static_cast<std::size_t>(i), sizeof sum);
    }
    for (int k = v.offsets[i]; k < v.offsets[i + 1]; ++k) {
      Four there;
      std::memcpy(&there, y + 4 * static_cast<std::size_t>(v.neighbours[k]), sizeof there);
      sum += v.weights[k] * there;
    }
    std::memcpy(x + 3 * static_cast<std::size_t>(i), &sum, 3 * sizeof(float));
  }
}

struct Kernels {
  void (*normal_terms)(const View&, int, int, float*);
  void (*average)(const View&, int, int, const float*, float*);
  void (*turned_deltas)(const View&, int, int, const float*, float*, float*, char*);
  void (*right_hand_side)(const View&, int, int, const float*, float*);
};

// NOLINTBEGIN(bugprone-macro-parentheses): an attribute cannot stand in parentheses
#define LAPEDIT_KERNELS(suffix, attribute)                                                                    \
  attribute void normal_terms_##suffix(const View& v, int first, int last, float* out) {                      \
    normal_terms(v, first, last, out);                                                                        \
  }                                                                                                           \
  attribute void average_##suffix(const View& v, int first, int last, const float* in, float* out) {          \
    average(v, first, last, in, out);                                                                         \
  }                                                                                                           \
  attribute void turned_deltas_##suffix(const View& v, int first, int last, const float* in, float* matrices, \
                                        float* out, char* hard) {                                             \
    turned_deltas(v, first, last, in, matrices, out, hard);                                                   \
  }                                                                                                           \
  attribute void right_hand_side_##suffix(const View& v, int first, int last, const float* y, float* x) {     \
    right_hand_side(v, first, last, y, x);                                                                    \
  }                                                                                                           \
  constexpr Kernels k_##suffix = {normal_terms_##suffix, average_##suffix, turned_deltas_##suffix,            \
                                  right_hand_side_##suffix};

// NOLINTEND(bugprone-macro-parentheses)

#define LAPEDIT_NOTHING
LAPEDIT_KERNELS(plain, LAPEDIT_NOTHING)
#ifdef LAPEDIT_HAVE_AVX
LAPEDIT_KERNELS(avx2, LAPEDIT_AVX2)
LAPEDIT_KERNELS(avx512, LAPEDIT_AVX512)
#endif

Kernels best_kernels() {
#ifdef LAPEDIT_HAVE_AVX
  switch (best_instructions()) {
    case Instructions::Avx512:
      return k_avx512;
    case Instructions::Avx2:
      return k_avx2;
    default:
      break;
  }
#endif
  return k_plain;
}

/// One lane of a vector.
float& lane_of(Vector& vector, int lane) {
  return reinterpret_cast<float*>(&vector)[lane];
}

}  // namespace

struct DragPreview::Inside {
  Kernels kernels = best_kernels();
  SparseCholesky& factor;
  std::shared_ptr<Crew> crew;
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

  Inside(SparseCholesky& used, std::shared_ptr<Crew> given) : factor(used), crew(std::move(given)) {}

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
  in_pieces(*crew, blocks, kGrain, [&](int first, int last) {
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
    in_pieces(*crew, blocks, kGrain, [&](int begin, int end) { kernels.average(v, begin, end, first(), second()); });
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
    in_pieces(*crew, blocks, kGrain, [&](int first_block, int last_block) {
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
    in_pieces(*crew, blocks, kGrain, [&](int first_block, int last_block) {
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
  in_pieces(*crew, blocks, kGrain, [&](int first_block, int last_block) {
    for (int place = first_block * kLanes; place < std::min(last_block * kLanes, size); ++place) {
      Four sum = smooth_rest[place];
      for (std::size_t a = 0; a < which.size(); ++a) {
        const float u = smooth_responses[static_cast<std::size_t>(place) * responses + which[a]];
        sum += u * Four{motion[3 * a], motion[3 * a + 1], motion[3 * a + 2], 0};
      }
      smooth_after[place] = sum;
    }
  });
  in_pieces(*crew, blocks, kGrain, [&](int first_block, int last_block) {
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
  in_pieces(*crew, blocks, kGrain, [&](int first_block, int last_block) {
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
                         std::shared_ptr<Crew> crew)
    : inside_(std::make_unique<Inside>(factor, std::move(crew))) {
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
  in_pieces(*s.crew, s.blocks, kGrain, [&](int first, int last) { s.kernels.normal_terms(v, first, last, s.first()); });
  s.average_times(v, kAveragingPasses - 1);  // the last one comes with the turning
  auto* const turned = reinterpret_cast<float*>(s.turned.data());
  in_pieces(*s.crew, s.blocks, kGrain, [&](int first, int last) {
    s.kernels.turned_deltas(v, first, last, s.first(), s.second(), turned, s.hard.data());
    s.turn_hard_ones(first, last);
  });
  in_pieces(*s.crew, s.blocks, kGrain,
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
  in_pieces(*s.crew, s.blocks, kGrain, [&](int first_block, int last_block) {
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
