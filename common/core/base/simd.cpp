// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/simd.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace lapedit {
namespace {

CpuLevel of_processor() {
#ifdef LAPEDIT_HAVE_AVX
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    return CpuLevel::Avx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return CpuLevel::Avx2;
  }
#endif
  return CpuLevel::Plain;
}

CpuLevel allowed() {
  const char* const text = std::getenv("LAPEDIT_INSTRUCTIONS");
  const std::string_view name = text != nullptr ? text : "";
  return name == "plain" ? CpuLevel::Plain : name == "avx2" ? CpuLevel::Avx2 : CpuLevel::Avx512;
}

}  // namespace

CpuLevel cpu_level() {
  static const CpuLevel best = std::min(of_processor(), allowed());
  return best;
}

}  // namespace lapedit
