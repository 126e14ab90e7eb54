// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_text.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "lapedit/base/error.h"
#include "script_support.h"

namespace lapedit::json_object_test {
namespace {

std::string refusal(const std::string& json) {
  return refusal_of([&json] { parse_json(json); });
}

TEST(JsonObject, SyntaxErrorsNameLineAndColumn) {
  const std::pair<std::string, const char*> cases[] = {
      {"{\"a\": 1,\n \"steps\": [1 2]}", "The text is not valid JSON: parse error at line 2, column 14: "},
      {"{\"a\": 1,\n\"b\": ?}", "line 2, column 6: "},
      {"{\"a\": 1,\n", "unexpected end of input"},
      {"{\"a\": 01}", "line 1, column 8: "},
      {"{\"a\": 1,}", "line 1, column 9: "},
      {"{'a': 1}", "line 1, column 2: "},
      {"// comment\n{}", "line 1, column 1: "},
      {"hello", "line 1, column 1: "},
      {"\xFF\xFE{", "The text is in UTF-16: save it in UTF-8."},
      {std::string("{\0\"\0a\0", 6), "The text is in UTF-16: save it in UTF-8."},
      {std::string("\0\1\2\3\4\5", 6), "byte 0"},
      {std::string("{\0}", 3), "The text is in UTF-16"},
      {std::string("{\0\0}", 4), "byte 0"},
      {"{\"a\": 1} 2", "expected end of input"},
      {std::string("{}\0", 3), "byte 0"},
      {"{\"a\": NaN}", "invalid literal"},
      {"{\"a\": [{}, 1e999]}", "a[1]: the number \"1e999\" is too large: give a smaller one."},
      {"{\"a\": [1.]}", "invalid number"},
      {"{\"a\": \"\x05\"}", "control character"},
      {"{\"a\": \"\xFF\"}", "UTF-8"},
      {"{\"a\": \"\n\"}", "control character"},
      {"{\"a", "missing closing quote"},
  };
  for (const auto& [text, expected] : cases) {
    expect_contains(refusal(text), expected);
  }
  for (const char* empty : {"", " \n\t", "\xEF\xBB\xBF"}) {
    expect_contains(refusal(empty), "empty");
  }
  expect_contains(refusal("[]"), "a list of length 0; it has to be a JSON object");
}

TEST(JsonObject, ByteOrderMarkIsSkipped) {
  EXPECT_EQ(refusal("\xEF\xBB\xBF{\"a\": 1}"), "");
}

TEST(JsonObject, RepeatedKeysAreRefusedWithTheirLocation) {
  EXPECT_EQ(refusal(R"({"b": [], "b": []})"), "edit: the key \"b\" is given twice in one object; keep one of the two.");
  expect_contains(refusal(R"({"\u0061b": 1, "ab": 2})"), "the key \"ab\"");
  expect_contains(refusal(R"({"x": [1, {"a": {"b":1, "b":2}}]})"), "x[1].a: the key \"b\"");
  expect_contains(refusal(R"({"a": {}, "b": 1, "a": {}})"), "the key \"a\"");
  EXPECT_EQ(refusal(R"({"a": [{"a": 1}, {"a": 1}], "b": {"a": "a"}})"), "");
  EXPECT_EQ(refusal(R"({"a": "\":\"", "b": "\":\""})"), "");
  EXPECT_EQ(refusal(R"({"a": "\"{}]: \\", "b": "\\\"", "c": ["a", "a"]})"), "");
}

TEST(JsonObject, DeepNestingIsRefused) {
  for (const std::size_t depth : {1025, 1000000}) {
    expect_contains(refusal("{\"a\":" + std::string(depth, '[')), "more than 1024 deep");
    std::string objects;
    for (std::size_t i = 0; i < depth; ++i) objects += "{\"a\":";
    expect_contains(refusal(objects), "more than 1024 deep");
  }
}

TEST(JsonObject, ObjectsWithManyKeysAreRefused) {
  std::string keys = "\"k\": 1";
  for (int k = 0; k < 99; ++k) keys += ", \"k" + std::to_string(k) + "\": 1";
  EXPECT_EQ(refusal("{" + keys + "}"), "");
  expect_contains(refusal("{\"a\": [{" + keys + ", \"b\": 1}]}"), "a[0]: the object has more than 100 keys");
}

TEST(JsonObject, HugeTextsAreRefused) {
  expect_contains(refusal(std::string((64 << 20) + 1, ' ')), "67108865 bytes; the limit is 67108864");
}

TEST(JsonObject, ForeignTextIsMadeFitForAMessage) {
  EXPECT_EQ(quoted_text("a\n\"b\a"), R"("a\n\"b\u0007")");
  EXPECT_EQ(quoted_text("\xC3\xA4"), "\"\xC3\xA4\"");
  EXPECT_EQ(quoted_text(std::string(60, 'x')), '"' + std::string(60, 'x') + '"');
  EXPECT_EQ(quoted_text(std::string(5000, 'x')), '"' + std::string(60, 'x') + "...\"");
  EXPECT_LT(quoted_text(std::string(5000, '\x80')).size(), 1000U);
  EXPECT_EQ(describe(Json()), "null");
  EXPECT_EQ(describe(true), "true");
  EXPECT_EQ(describe(0.5), "the number 0.5");
  EXPECT_EQ(describe(Json::array({1, 2})), "a list of length 2");
  EXPECT_EQ(describe(Json::object()), "an object");
}

}  // namespace
}  // namespace lapedit::json_object_test
