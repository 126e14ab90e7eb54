// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/preview_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lapedit/base/cpu_dispatch.h"

namespace lapedit::preview {
namespace {

typedef float Half __attribute__((vector_size(kLanes / 2 * sizeof(float))));
typedef int IntVector __attribute__((vector_size(kLanes * sizeof(int))));

/// x^-1/2: a first guess from the exponent's bits, then Newton's y <- y (3 - x y^2) / 2.
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

/// |C| n1 n0^T of some blocks: C = C0 + sum_r w_r g_r^T, n1 along a0 + b x w for one response that moves.
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

/// B = (1 - hold) C / |C| + hold I, made length 1, C the averages of a block's matrices.
LAPEDIT_INLINE void faded_covariances(const View& v, int block, const float* in, Vector* b) {
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
  const Vector rest[9] = {s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]};
  for (int e = 0; e < 9; ++e) {
    b[e] = rest[e] + load(columns[e]);
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
}

/// (R - I) delta, R the rotation nearest to B, |B| = 1, by Markley's formula (FOAM, 1993), which is exact and needs the
/// largest root of a quartic only: R = ((kappa + |B|^2) B + lambda adj(B)^T - B B^T B) / zeta, with lambda that root of
/// (lambda^2 - |B|^2)^2 = 8 lambda det B + 4 |adj B|^2, kappa = (lambda^2 - |B|^2) / 2, zeta = kappa lambda - det B.
/// @return zeta, which is small where few digits are left
LAPEDIT_INLINE Vector turn(const Vector* b, const Vector* delta, Vector* turned) {
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
  Vector gram[9];  // B B^T
  for (std::ptrdiff_t i = 0; i < 3; ++i) {
    for (std::ptrdiff_t j = 0; j < 3; ++j) {
      gram[3 * i + j] = b[3 * i] * b[3 * j] + b[3 * i + 1] * b[3 * j + 1] + b[3 * i + 2] * b[3 * j + 2];
    }
  }
  // B delta and B B^T B delta, without making the product of the matrices.
  Vector once[3];
  for (std::ptrdiff_t i = 0; i < 3; ++i) {
    once[i] = b[3 * i] * delta[0] + b[3 * i + 1] * delta[1] + b[3 * i + 2] * delta[2];
  }
  for (std::ptrdiff_t i = 0; i < 3; ++i) {
    const Vector thrice = gram[3 * i] * once[0] + gram[3 * i + 1] * once[1] + gram[3 * i + 2] * once[2];
    const Vector cofactors = f[3 * i] * delta[0] + f[3 * i + 1] * delta[1] + f[3 * i + 2] * delta[2];
    turned[i] = ((kappa + 1.0F) * once[i] + root * cofactors - thrice) * inverse - delta[i];
  }
  return zeta;
}

/// Turned deltas of some blocks. Vertices that are left too few digits are marked in `hard`, for the caller to do over
/// with the matrices left in `matrices`.
LAPEDIT_INLINE void turned_deltas(const View& v, int first, int last, const float* in, float* matrices, float* out,
                                  char* hard) {
  constexpr float kFewDigits = 0.02F;
  for (int block = first; block < last; ++block) {
    Vector b[9], turned[3];
    faded_covariances(v, block, in, b);
    const Vector zeta = turn(b, v.base[block].delta, turned);
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
      any = any || !(digits[lane] > kFewDigits);
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
        kept[9] = digits[lane] > kFewDigits ? 0.0F : 1.0F;
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
      sum *= v.own[i];
    }
    for (int k = v.offsets[i]; k < v.offsets[i + 1]; ++k) {
      Four there;
      std::memcpy(&there, y + 4 * static_cast<std::size_t>(v.neighbours[k]), sizeof there);
      sum += v.weights[k] * there;
    }
    std::memcpy(x + 3 * static_cast<std::size_t>(i), &sum, 3 * sizeof(float));
  }
}

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

}  // namespace

Kernels best_kernels() {
#ifdef LAPEDIT_HAVE_AVX
  switch (cpu_level()) {
    case CpuLevel::Avx512:
      return k_avx512;
    case CpuLevel::Avx2:
      return k_avx2;
    default:
      break;
  }
#endif
  return k_plain;
}

}  // namespace lapedit::preview
