// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

namespace lapedit {

/// Lists of integers of different lengths, as compressed sparse rows have them: row i is values[offsets[i] .. offsets[i
/// + 1]).
struct CompressedRows {
  struct Row {
    const int* first;
    const int* last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
    int size() const { return static_cast<int>(last - first); }
  };

  std::vector<int> offsets{0};
  std::vector<int> values;

  int rows() const { return static_cast<int>(offsets.size()) - 1; }
  Row operator[](int row) const { return {values.data() + offsets[row], values.data() + offsets[row + 1]}; }
  /// Returns the index in `values` of a value of an ascending row.
  int entry(int row, int value) const {
    const int first = offsets[row], last = offsets[row + 1];
    constexpr int kShort = 16;
    if (last - first > kShort) {
      return static_cast<int>(std::lower_bound(values.begin() + first, values.begin() + last, value) - values.begin());
    }
    int position = first;
    for (int k = first; k < last; ++k) {  // without branches that the processor cannot predict
      position += values[k] < value;
    }
    return position;
  }
};

}  // namespace lapedit
