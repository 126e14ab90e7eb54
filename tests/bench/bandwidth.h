// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace speed {

/// What any solve with a factor has to do at the least: read it twice.
class Bandwidth {
 public:
  explicit Bandwidth(std::size_t doubles) : data_(doubles, 1.0) {}

  /// Seconds for reading all of it twice, each thread its own share; the best
  /// of several.
  double seconds(int threads);
  /// Sum that the last reading found, over the right one, minus 1.
  double error() const { return error_; }

 private:
  std::vector<double> data_;
  double error_ = 0;
};

}  // namespace speed
