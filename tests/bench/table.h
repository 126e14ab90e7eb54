// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "lapedit/base/format_text.h"

/// Markdown tables on standard output, for all benchmarks.
namespace table {

using Cells = std::vector<std::string>;

inline void print_row(const Cells& cells) {
  for (const std::string& cell : cells) std::printf("| %s ", cell.c_str());
  std::printf("|\n");
  std::fflush(stdout);  // rows take long
}

inline void print_head(const Cells& head) {
  std::printf("\n");
  print_row(head);
  Cells line(head.size(), "--:");
  line.front() = "---";
  print_row(line);
}

/// Formats a number; "-" if it is not finite, bold if it exceeds its target.
inline std::string number(double value, const char* format = "%.3g",
                          double target = std::numeric_limits<double>::infinity()) {
  if (!std::isfinite(value)) return "-";
  const std::string text = lapedit::format_text(format, value);
  return value <= target ? text : "**" + text + "**";
}

inline double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace table
