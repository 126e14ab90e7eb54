// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
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

/// Returns lists of values. @param each  calls a function (row, value) for each entry, those of a row in their order;
/// is called twice
template <class Each>
CompressedRows lists_of(int rows, const Each& each) {
  CompressedRows lists;
  lists.offsets.assign(static_cast<std::size_t>(rows) + 1, 0);
  each([&](int row, int) { ++lists.offsets[row + 1]; });
  std::partial_sum(lists.offsets.begin(), lists.offsets.end(), lists.offsets.begin());
  lists.values.resize(lists.offsets.back());
  std::vector<int> next(lists.offsets.begin(), lists.offsets.end() - 1);
  each([&](int row, int value) { lists.values[next[row]++] = value; });
  return lists;
}

}  // namespace lapedit
