// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any bytes as a file of the format OFF.
#include "mesh_file_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return lapedit::fuzz::run(readOff, data, size);
}
