// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace lapedit {

/// Returns the whole part of a number within [low, high], and low for NaN. A mere cast of other numbers is undefined.
template <class Whole>
Whole whole_part(double number, Whole low, Whole high) {
  return !(number > static_cast<double>(low)) ? low
         : number < static_cast<double>(high) ? static_cast<Whole>(number)
                                              : high;
}

}  // namespace lapedit
