// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstring>

#include "lapedit/base/compiler.h"

// Compiles kernels for several generations of processors in one build. A kernel is an always-inlined template. For each
// generation one function with that generation's attribute calls it. Vectors are GCC's and clang's vector types.

namespace lapedit {

enum class CpuLevel { Plain, Avx2, Avx512 };

/// Returns the best instructions that this processor and its operating system have. The environment variable
/// LAPEDIT_INSTRUCTIONS=avx2 or =plain limits them, as on an older processor. The result never changes in a process.
CpuLevel cpu_level();

/// `lanes` numbers that are added, multiplied and so on together. Containers do not align more than 16 bytes: those of
/// larger vectors hold numbers, to be read by load().
template <class Scalar, int lanes>
struct Simd {
  typedef Scalar Vector __attribute__((vector_size(lanes * sizeof(Scalar))));
};
/// Returns the given lanes of two vectors, those of b numbered after those of a.
template <int... numbers, class Vector>
LAPEDIT_INLINE Vector shuffle(Vector a, Vector b) {
  return __builtin_shufflevector(a, b, numbers...);
}
/// Returns, for each lane, that of a where the mask is set, else that of b.
template <class Mask, class Vector>
LAPEDIT_INLINE Vector select(Mask mask, Vector a, Vector b) {
  return mask ? a : b;
}
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
