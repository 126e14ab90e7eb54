// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "lapedit/base/compiler.h"

// Compiles kernels for several generations of processors in one build. A kernel is an always-inlined template. For each
// generation one function with that generation's attribute calls it. Vectors are GCC's and clang's vector types, or
// with LAPEDIT_PLAIN_KERNELS arrays of numbers.

namespace lapedit {

enum class CpuLevel { Plain, Avx2, Avx512 };

/// Returns the best instructions that this processor and its operating system have. The environment variable
/// LAPEDIT_INSTRUCTIONS=avx2 or =plain limits them, as on an older processor. The result never changes in a process.
CpuLevel cpu_level();

/// `lanes` numbers that are added, multiplied and so on together. Containers do not align more than 16 bytes: those of
/// larger vectors hold numbers, to be read by load().
#ifdef LAPEDIT_PLAIN_KERNELS
template <class Scalar, int lanes>
struct PlainVector {
  Scalar lane[lanes];

  Scalar& operator[](std::ptrdiff_t k) { return lane[k]; }
  const Scalar& operator[](std::ptrdiff_t k) const { return lane[k]; }

#define LAPEDIT_OPERATOR(sign)                                            \
  PlainVector& operator sign##=(const PlainVector& b) {                   \
    return *this = *this sign b;                                          \
  }                                                                       \
  PlainVector& operator sign##=(Scalar b) {                               \
    return *this = *this sign b;                                          \
  }                                                                       \
  friend PlainVector operator sign(Scalar a, const PlainVector& b) {      \
    return filled(a) sign b;                                              \
  }                                                                       \
  friend PlainVector operator sign(const PlainVector& a, Scalar b) {      \
    return a sign filled(b);                                              \
  }                                                                       \
  friend PlainVector operator sign(PlainVector a, const PlainVector& b) { \
    for (int k = 0; k < lanes; ++k) {                                     \
      a.lane[k] = a.lane[k] sign b.lane[k];                               \
    }                                                                     \
    return a;                                                             \
  }
  LAPEDIT_OPERATOR(+)
  LAPEDIT_OPERATOR(-)
  LAPEDIT_OPERATOR(*)
  LAPEDIT_OPERATOR(/)
  LAPEDIT_OPERATOR(&)
  LAPEDIT_OPERATOR(|)
#undef LAPEDIT_OPERATOR

  /// The result of a comparison: all bits of a lane are set where it holds.
  using Mask = PlainVector<std::conditional_t<sizeof(Scalar) == 8, std::int64_t, std::int32_t>, lanes>;
#define LAPEDIT_COMPARISON(sign)                                          \
  friend Mask operator sign(const PlainVector& a, Scalar b) {             \
    return a sign filled(b);                                              \
  }                                                                       \
  friend Mask operator sign(const PlainVector& a, const PlainVector& b) { \
    Mask result;                                                          \
    for (int k = 0; k < lanes; ++k) {                                     \
      result.lane[k] = a.lane[k] sign b.lane[k] ? -1 : 0;                 \
    }                                                                     \
    return result;                                                        \
  }
  LAPEDIT_COMPARISON(<)
  LAPEDIT_COMPARISON(>)
  LAPEDIT_COMPARISON(!=)
#undef LAPEDIT_COMPARISON

  friend PlainVector operator-(PlainVector a) {
    for (Scalar& each : a.lane) {
      each = -each;
    }
    return a;
  }
  friend PlainVector operator~(PlainVector a) {
    for (Scalar& each : a.lane) {
      each = ~each;
    }
    return a;
  }

 private:
  static PlainVector filled(Scalar value) {
    PlainVector result;
    for (Scalar& each : result.lane) {
      each = value;
    }
    return result;
  }
};
template <class Scalar, int lanes>
struct Simd {
  using Vector = PlainVector<Scalar, lanes>;
};
/// Returns the given lanes of two vectors, those of b numbered after those of a.
template <int... numbers, class Scalar, int lanes>
PlainVector<Scalar, lanes> shuffle(const PlainVector<Scalar, lanes>& a, const PlainVector<Scalar, lanes>& b) {
  return {{(numbers < lanes ? a.lane[numbers % lanes] : b.lane[numbers % lanes])...}};
}
/// Returns, for each lane, that of a where the mask is set, else that of b.
template <class Mask, class Scalar, int lanes>
PlainVector<Scalar, lanes> select(const Mask& mask, PlainVector<Scalar, lanes> a, const PlainVector<Scalar, lanes>& b) {
  for (int k = 0; k < lanes; ++k) {
    a.lane[k] = mask.lane[k] != 0 ? a.lane[k] : b.lane[k];
  }
  return a;
}
#else
template <class Scalar, int lanes>
struct Simd {
  typedef Scalar Vector LAPEDIT_VECTOR_SIZE(lanes * sizeof(Scalar));
};
/// Returns the given lanes of two vectors, those of b numbered after those of a.
template <int... numbers, class Vector>
LAPEDIT_INLINE Vector shuffle(Vector a, Vector b) {
  return LAPEDIT_SHUFFLE(a, b, numbers...);
}
/// Returns, for each lane, that of a where the mask is set, else that of b.
template <class Mask, class Vector>
LAPEDIT_INLINE Vector select(Mask mask, Vector a, Vector b) {
  return mask ? a : b;
}
#endif
using Floats4 = Simd<float, 4>::Vector;
using Doubles4 = Simd<double, 4>::Vector;

template <class Vector, class Scalar>
LAPEDIT_INLINE Vector load(const Scalar* from) {
  Vector result;
  std::memcpy(&result, from, sizeof result);
  return result;
}
template <class Vector, class Scalar>
LAPEDIT_INLINE void store(Scalar* to, Vector vector) {
  std::memcpy(to, &vector, sizeof vector);
}
/// Returns three numbers and 0. A template, since not every file that includes this has vectors of 32 bytes.
template <class Scalar>
LAPEDIT_INLINE typename Simd<Scalar, 4>::Vector load3(const Scalar* from) {
  return typename Simd<Scalar, 4>::Vector{from[0], from[1], from[2], 0};
}
/// Returns a b + c, rounded once.
LAPEDIT_INLINE double fused(double a, double b, double c) {
  return std::fma(a, b, c);
}
/// Returns the variant of a function that was compiled for cpu_level().
template <class Function>
Function for_processor(Function plain, Function avx2, Function avx512) {
  return cpu_level() == CpuLevel::Avx512 ? avx512 : cpu_level() == CpuLevel::Avx2 ? avx2 : plain;
}

template <class Kernel>
void run_plain(const Kernel& kernel, int first, int last) {
  for (int i = first; i < last; ++i) {
    kernel(i);
  }
}
template <class Kernel>
LAPEDIT_AVX2 void run_avx2(const Kernel& kernel, int first, int last) {
  for (int i = first; i < last; ++i) {
    kernel(i);
  }
}
/// Calls kernel(i) for the indices from first to last, with this processor's instructions. The call operator has to be
/// LAPEDIT_INLINE.
template <class Kernel>
void run_kernel(const Kernel& kernel, int first, int last) {
  for_processor(run_plain<Kernel>, run_avx2<Kernel>, run_avx2<Kernel>)(kernel, first, last);
}

}  // namespace lapedit
