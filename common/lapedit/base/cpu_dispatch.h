// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Kernels for several generations of processors in one build, for the few files that need them: a kernel is an
// always-inlined template, and one function per generation, with that generation's attribute, calls it. Vectors are
// GCC's and clang's vector types, which every generation can compile.

#define LAPEDIT_INLINE inline __attribute__((always_inline))

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

/// Returns, of functions that do the same, the one for cpu_level().
template <class Function>
Function for_processor(Function plain, Function avx2, Function avx512) {
  return cpu_level() == CpuLevel::Avx512 ? avx512 : cpu_level() == CpuLevel::Avx2 ? avx2 : plain;
}

}  // namespace lapedit
