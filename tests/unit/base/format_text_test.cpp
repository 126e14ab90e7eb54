// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/format_text.h"

#include <gtest/gtest.h>

#include <limits>
#include <locale>
#include <string>

namespace lapedit::format_text_test {
namespace {

TEST(FormatText, IsPrintfs) {
  EXPECT_EQ(format_text("%d of %s, %.3g", 3, "five", 0.12345), "3 of five, 0.123");
  EXPECT_EQ(format_text("%s", std::string(5000, 'x').c_str()), std::string(5000, 'x'));
}

/// Decimal comma, and a dot after each three digits.
class Elsewhere : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(FormatText, NumbersAreTheSameInEveryLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Elsewhere));
  EXPECT_EQ(number_text(12345.5), "12345.5");
  std::locale::global(before);
  EXPECT_EQ(number_text(1e-7), "1e-07");
  EXPECT_EQ(number_text(-3), "-3");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
}

}  // namespace
}  // namespace lapedit::format_text_test
