// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bitset>
#include <cstdint>

// Wraps the extensions that only GCC and clang have. With LAPEDIT_PLAIN_KERNELS, and with other compilers, each has a
// plain C++17 form.

#if defined(__GNUC__) && !defined(LAPEDIT_PLAIN_KERNELS)
#define LAPEDIT_ALWAYS_INLINE __attribute__((always_inline))
#define LAPEDIT_PRAGMA(text) _Pragma(#text)
/// Unrolls the loop that follows, so that its sums stay in registers.
#define LAPEDIT_UNROLL(count) LAPEDIT_PRAGMA(GCC unroll count)
#define LAPEDIT_VECTOR_SIZE(bytes) __attribute__((vector_size(bytes)))
#define LAPEDIT_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
#define LAPEDIT_ALWAYS_INLINE
#define LAPEDIT_UNROLL(count)
#ifndef LAPEDIT_PLAIN_KERNELS
#define LAPEDIT_PLAIN_KERNELS
#endif
#endif
#define LAPEDIT_INLINE inline LAPEDIT_ALWAYS_INLINE
#ifdef __GNUC__
#ifdef __MINGW32__  // mingw's printf() is GNU's in C++, but GCC checks formats against Microsoft's
#define LAPEDIT_PRINTF(text, first) __attribute__((format(gnu_printf, text, first)))
#else
#define LAPEDIT_PRINTF(text, first) __attribute__((format(printf, text, first)))
#endif
#else
#define LAPEDIT_PRINTF(text, first)
#endif

#if defined(__x86_64__) && !defined(LAPEDIT_PLAIN_KERNELS)
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

#ifdef __GNUC__
LAPEDIT_INLINE void prefetch(const void* position) {
  __builtin_prefetch(position);
}
LAPEDIT_INLINE int count_bits(std::uint64_t word) {
  return __builtin_popcountll(word);
}
LAPEDIT_INLINE int lowest_bit(std::uint64_t word) {
  return __builtin_ctzll(word);
}
#else
inline void prefetch(const void*) {}
inline int count_bits(std::uint64_t word) {
  return static_cast<int>(std::bitset<64>(word).count());
}
inline int lowest_bit(std::uint64_t word) {
  return count_bits((word & (~word + 1)) - 1);
}
#endif
/// Lets the processor save power in a loop that waits for another thread.
inline void pause_processor() {
#if defined(__GNUC__) && (defined(__x86_64__) || defined(__i386__))
  __builtin_ia32_pause();
#elif defined(__GNUC__) && defined(__aarch64__)
  __asm__ __volatile__("yield");
#endif
}

}  // namespace lapedit
