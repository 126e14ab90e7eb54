// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/instructions.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace lapedit {
namespace {

Instructions of_processor() {
#ifdef LAPEDIT_HAVE_AVX
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) {
    return Instructions::Avx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    return Instructions::Avx2;
  }
#endif
  return Instructions::Plain;
}

Instructions allowed() {
  const char* const text = std::getenv("LAPEDIT_INSTRUCTIONS");
  const std::string_view name = text != nullptr ? text : "";
  return name == "plain" ? Instructions::Plain : name == "avx2" ? Instructions::Avx2 : Instructions::Avx512;
}

}  // namespace

Instructions best_instructions() {
  static const Instructions best = std::min(of_processor(), allowed());
  return best;
}

}  // namespace lapedit
