// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

// Wraps extensions of GCC and clang.

#ifndef __GNUC__
#error "Use GCC or clang: kernels need their vector types."
#endif

#define LAPEDIT_ALWAYS_INLINE __attribute__((always_inline))
#define LAPEDIT_INLINE inline LAPEDIT_ALWAYS_INLINE
#define LAPEDIT_PRAGMA(text) _Pragma(#text)
/// Unrolls the loop that follows, so that its sums stay in registers.
#define LAPEDIT_UNROLL(count) LAPEDIT_PRAGMA(GCC unroll count)
#define LAPEDIT_PRINTF(text, first) __attribute__((format(printf, text, first)))

#ifdef __x86_64__
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

LAPEDIT_INLINE void prefetch(const void* position) {
  __builtin_prefetch(position);
}
LAPEDIT_INLINE int count_bits(std::uint64_t word) {
  return __builtin_popcountll(word);
}
LAPEDIT_INLINE int lowest_bit(std::uint64_t word) {
  return __builtin_ctzll(word);
}
/// Lets the processor save power in a loop that waits for another thread.
inline void pause_processor() {
#ifdef __x86_64__
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ __volatile__("yield");
#endif
}

}  // namespace lapedit
