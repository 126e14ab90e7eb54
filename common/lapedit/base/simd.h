// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstring>

// All that only GCC and clang understand.
//
// Kernels for several generations of processors in one build, for the few files that need them: a kernel is an
// always-inlined template, and one function per generation, with that generation's attribute, calls it. Vectors are
// GCC's and clang's vector types, which every generation can compile.

#define LAPEDIT_ALWAYS_INLINE __attribute__((always_inline))
#define LAPEDIT_INLINE inline LAPEDIT_ALWAYS_INLINE
#define LAPEDIT_PRINTF(text, first) __attribute__((format(printf, text, first)))
/// Lanes of two vectors, numbered through.
#define LAPEDIT_SHUFFLE __builtin_shufflevector

#if defined(__x86_64__)
#define LAPEDIT_HAVE_AVX 1
#define LAPEDIT_AVX2 __attribute__((target("avx2,fma")))
#ifdef __clang__
#define LAPEDIT_AVX512 __attribute__((target("avx512f,avx512vl,avx512dq,avx2,fma")))
#else
#define LAPEDIT_AVX512 __attribute__((target("avx512f,avx512vl,avx512dq,avx2,fma,prefer-vector-width=512")))
#endif
#else
#define LAPEDIT_AVX2
#define LAPEDIT_AVX512
#endif

namespace lapedit {

enum class CpuLevel { Plain, Avx2, Avx512 };

/// The best that this processor and its operating system have; with LAPEDIT_INSTRUCTIONS=avx2 or =plain in the
/// environment no better than that, as on an older processor. The same all the time.
CpuLevel cpu_level();

/// `lanes` numbers that are added, multiplied and so on together. Containers do not align more than 16 bytes: those of
/// larger vectors hold numbers, to be read by load().
template <class Scalar, int lanes>
struct Simd {
  typedef Scalar Vector __attribute__((vector_size(lanes * sizeof(Scalar))));
};
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
LAPEDIT_INLINE void prefetch(const void* place) {
  __builtin_prefetch(place);
}
LAPEDIT_INLINE int count_bits(std::uint64_t word) {
  return __builtin_popcountll(word);
}
LAPEDIT_INLINE int lowest_bit(std::uint64_t word) {
  return __builtin_ctzll(word);
}
/// a b + c, rounded once.
LAPEDIT_INLINE double fused(double a, double b, double c) {
  return __builtin_fma(a, b, c);
}
/// Tells the processor that this is a loop that waits.
inline void pause_processor() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ __volatile__("yield");
#endif
}

/// Returns, of functions that do the same, the one for cpu_level().
template <class Function>
Function for_processor(Function plain, Function avx2, Function avx512) {
  return cpu_level() == CpuLevel::Avx512 ? avx512 : cpu_level() == CpuLevel::Avx2 ? avx2 : plain;
}

}  // namespace lapedit
