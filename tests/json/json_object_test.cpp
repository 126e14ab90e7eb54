// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/json_object.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "lapedit/base/error.h"
#include "script_support.h"

namespace lapedit {
namespace {

std::string refusal(const std::string& json) {
  return refusal_of([&json] { parse_json(json); });
}

TEST(JsonObject, NumbersReadBackAsTheSameDouble) {
  std::mt19937_64 random(2);
  const auto any_double = [&] {
    const std::uint64_t bits = random();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  using Limits = std::numeric_limits<double>;
  std::vector<double> values = {0.0, -0.0, 0.1, 1.0 / 3, 1e300, 1e22, 1e23, 9007199254740993.0};
  for (const double value :
       {Limits::max(), Limits::min(), Limits::denorm_min(), std::ldexp(1.0, 63), std::ldexp(1.0, 64)}) {
    values.insert(values.end(), {value, -value, std::nextafter(value, 0.0), std::nextafter(-value, 0.0)});
  }
  for (int i = 0; i < 50000; ++i) {
    values.push_back(any_double());
    values.push_back(std::ldexp(static_cast<double>(random() >> 12), -1074));                     // mostly denormal
    values.push_back(static_cast<double>(static_cast<std::int64_t>(random()) >> random() % 64));  // whole
    const auto bits = static_cast<std::uint32_t>(random());
    float stored;  // what MeshLab's meshes hold
    std::memcpy(&stored, &bits, sizeof stored);
    values.push_back(static_cast<double>(stored));
  }
  int compared = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) {
      continue;
    }
    const std::string text = "{\"x\":" + json_number(value) + "}";
    const double read = JsonObject(parse_json(text), "test", {"x"}).number("x", 7);
    ASSERT_EQ(read, value) << text;  // the same bits, but for the sign of zero, which is dropped
    ++compared;
  }
  EXPECT_GT(compared, 190000);
}

TEST(JsonObject, NumbersAreWrittenAsTheyAlwaysWere) {
  const std::pair<double, const char*> cases[] = {{-0.0, "0"},
                                                  {-12, "-12"},
                                                  {0.25, "0.25"},
                                                  {1e-4, "0.0001"},
                                                  {1.5e-5, "1.5e-05"},
                                                  {123456.75, "123456.75"},
                                                  {9007199254740993.0, "9007199254740992"},
                                                  {1e19, "10000000000000000000"},
                                                  {-119128452083111428096.0, "-119128452083111430000"},
                                                  {1e22, "1e+22"},
                                                  {-1.25e-300, "-1.25e-300"}};
  for (const auto& [number, text] : cases) {
    EXPECT_EQ(json_number(number), text);
  }
}

TEST(JsonObject, SyntaxErrorsNameLineAndColumn) {
  const std::pair<std::string, const char*> cases[] = {
      {"{\"a\": 1,\n \"steps\": [1 2]}", "Near line 2, column 14: the edit is not valid JSON ("},
      {"{\"a\": 1,\n\"\xC3\xA4\xC3\xA4\": ?}", "Near line 2, column 6: "},
      {"{\"a\": 1,\n", "Near line 1, column 9: "},
      {"{\"a\": 01}", "Near line 1, column 8: "},
      {"{\"a\": 1,}", "Near line 1, column 9: "},
      {"{'a': 1}", "Near line 1, column 2: "},
      {"// comment\n{}", "Near line 1, column 1: "},
      {"hello", "Near line 1, column 1: "},
      {"\xFF\xFE{", "Near line 1, column 1: "},
      {"{\"a\": 1} x", "garbage"},
      {std::string("{}\0", 3), "garbage"},
      {std::string("\0{}", 3), "Near line 1, column 1: "},
      {"{\"a\": NaN}", "illegal number"},
      {"{\"a\": -Infinity}", "illegal number"},
      {"{\"a\": 1e999}", "illegal number"},
      {"{\"a\": [1.]}", "column 8: the edit is not valid JSON (illegal number)."},
      {"{\"a\": nul}", "(illegal value)"},
      {"{\"a\": \"\x05\"}", "column 8: the edit is not valid JSON (unescaped control character)."},
      {"{\"a\": .5}", "(illegal number)"},
      {"{\"a\": [1", "(unterminated array)"},
      {"{\"a\": \"\xFF\"}", "UTF8"},
      {"{\"a\": \"\n\\x\"}", "Near line 2, column 2: the edit is not valid JSON (invalid escape sequence)."},
      {"{\"\\\": 1}", "not valid JSON"},
      {"}{", "Near line 1, column 1: "},
      {"\"a\":1", "Near line 1, column 1: "},
      {"{\"a\\", "not valid JSON"},
      {"{\"a\"", "not valid JSON"},
  };
  for (const auto& [text, part] : cases) {
    expect_contains(refusal(text), part);
  }
  for (const char* empty : {"", " \n\t", "\xEF\xBB\xBF"}) {
    expect_contains(refusal(empty), "empty");
  }
  expect_contains(refusal("[]"), "a JSON list; it has to be an object");
}

TEST(JsonObject, ByteOrderMarkIsSkipped) {
  EXPECT_EQ(refusal("\xEF\xBB\xBF{\"a\": 1}"), "");
}

TEST(JsonObject, RepeatedKeysAreRefusedWithTheirPlace) {
  EXPECT_EQ(refusal("{\"a\": 1,\n \"b\": [], \"b\": []}"),
            "At line 2, column 11: the key \"b\" is given twice in one object; keep one of the two.");
  expect_contains(refusal(R"({"\u0061b": 1, "ab": 2})"), "the key \"ab\"");
  expect_contains(refusal("{\"x\": [{\"a\" : {\"b\":1, \"b\"\n\t:2}}]}"), "the key \"b\"");
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

TEST(JsonObject, HugeTextsAreRefused) {
  expect_contains(refusal(std::string((64 << 20) + 1, ' ')), "67108865 bytes; the limit is 67108864");
}

TEST(JsonObject, ForeignTextIsMadeFitForAMessage) {
  EXPECT_EQ(quoted_text("a\n\"b\a"), R"("a\n\"b\u0007")");
  EXPECT_EQ(quoted_text("\xC3\xA4"), "\"\xC3\xA4\"");
  EXPECT_EQ(quoted_text(std::string(60, 'x')), '"' + std::string(60, 'x') + '"');
  EXPECT_EQ(quoted_text(std::string(5000, 'x')), '"' + std::string(60, 'x') + "...\"");
  EXPECT_EQ(describe(Json()), "null");
  EXPECT_EQ(describe(true), "true");
  EXPECT_EQ(describe(0.5), "the number 0.5");
  EXPECT_EQ(describe(Json::array({1, 2})), "a list of length 2");
  EXPECT_EQ(describe(Json::object()), "an object");
}

}  // namespace
}  // namespace lapedit
