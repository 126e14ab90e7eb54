// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

namespace lapedit {

/// Concatenated lists of integers of different lengths: row i is values[offsets[i] .. offsets[i + 1]).
struct IndexLists {
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
    return static_cast<int>(std::lower_bound(values.begin() + offsets[row], values.begin() + offsets[row + 1], value) -
                            values.begin());
  }
};

}  // namespace lapedit
