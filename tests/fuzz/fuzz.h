// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

/// What the fuzz targets share. A target is one file with LLVMFuzzerTestOneInput(); libFuzzer's main() calls it with
/// new inputs, replay.cpp with those of the corpus.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace lapedit::fuzz {

/// A property that does not hold is a finding, as a bad access is one.
inline void require(bool holds, const char* property) {
  if (!holds) {
    std::fprintf(stderr, "Does not hold: %s\n", property);
    std::abort();
  }
}

/// Choices out of an input; after its end all are 0.
class Choices {
 public:
  Choices(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  bool more() const { return at_ != end_; }
  int byte() { return more() ? *at_++ : 0; }
  int below(int count) { return byte() % count; }
  bool flag() { return (byte() & 1) != 0; }
  /// Sixteen bits, from 0 to count - 1.
  int index(int count) {
    const int low = byte();
    return (low + 256 * byte()) % count;
  }

  /// From -4 to 4 in steps of 1/32, now and then what arithmetic is afraid of.
  double real() {
    static constexpr double kHard[] = {0,    -0.0,  1e-300, -1e-300, 1e300, -1e300, 1e38, -3.5e38,
                                       1e20, 1e-20, 5e-324, 1e-45,   1e9,   1e150,  1e-8, -1e19};
    const int first = byte();
    return first == 255 ? kHard[byte() % 16] : (first - 128) / 32.0;
  }

 private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

}  // namespace lapedit::fuzz
