// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/base/translate.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "lapedit/base/format_text.h"

namespace lapedit {
namespace {

class Translate : public testing::Test {
 protected:
  ~Translate() override { set_translator({}); }

  void know(const std::map<std::string, std::string>& sentences) {
    set_translator([sentences](const char* sentence) {
      const auto found = sentences.find(sentence);
      return found != sentences.end() ? found->second : std::string(sentence);
    });
  }
};

TEST_F(Translate, SentencesAreEnglishUnlessSomebodyTranslates) {
  EXPECT_STREQ(translated("a step"), "a step");
  know({{"a step", "ein Schritt"}});
  EXPECT_STREQ(translated("a step"), "ein Schritt");
  EXPECT_STREQ(translated("another"), "another");
  set_translator({});
  EXPECT_STREQ(translated("a step"), "a step");
}

TEST_F(Translate, OtherConversionsAreNotTaken) {
  know({{"%zu of %d", "%d von %zu"},
        {"%d of %s", "%d von %s"},
        {"%.1f ms", "%.1f ms, %s"},
        {"%d, 100 %%", "100 %% von %d"},
        {"no conversion", "100 %"}});
  EXPECT_EQ(format_text(translated("%zu of %d"), std::size_t(3), 4), "3 of 4");
  EXPECT_EQ(format_text(translated("%d of %s"), 3, "four"), "3 von four");
  EXPECT_EQ(format_text(translated("%.1f ms"), 0.5), "0.5 ms");
  EXPECT_STREQ(translated("%d, 100 %%"), "%d, 100 %%");
  EXPECT_STREQ(translated("no conversion"), "no conversion");
}

TEST_F(Translate, HandedOutSentencesStay) {
  know({{"first", "eins"}, {"second", "zwei"}});
  const char* const first = translated("first");
  EXPECT_STREQ(translated("second"), "zwei");
  EXPECT_STREQ(first, "eins");
  EXPECT_EQ(first, translated("first"));
}

}  // namespace
}  // namespace lapedit
