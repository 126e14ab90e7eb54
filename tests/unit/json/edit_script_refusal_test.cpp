// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "allocation_watch.h"
#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/json/json_text.h"
#include "script_support.h"

namespace lapedit::edit_script_refusal_test {
namespace {

/// JSON with ' for ".
std::string js(const std::string& text) {
  std::string json = text;
  std::replace(json.begin(), json.end(), '\'', '"');
  return json;
}

std::string with_steps(const std::string& steps, const std::string& mesh = "") {
  return js("{'laplacian_edit': 1, " + (mesh.empty() ? mesh : "'mesh': " + mesh + ", ") + "'steps': [" + steps + "]}");
}
std::string with_mesh(const std::string& mesh, const std::string& ranges = "1") {
  return with_steps("{'region': {'radius': 1}, 'handles': [{'vertices': '" + ranges + "'}]}", mesh);
}
std::string with_region(const std::string& region) {
  return with_steps("{'region': " + region + ", 'handles': [{'vertices': '1'}]}");
}
std::string with_handle(const std::string& handle) {
  return with_steps("{'region': {'radius': 1}, 'handles': [" + handle + "]}");
}
std::string with_setting(const std::string& setting) {
  return with_steps("{'region': {'radius': 1}, 'handles': [{'vertices': '1'}], " + setting + "}");
}
std::string with_ranges(const std::string& ranges) {
  return with_handle("{'vertices': '" + ranges + "'}");
}

std::string refusal(const std::string& json) {
  return refusal_of([&json] { read_edit(json); });
}

TEST(EditScriptRefusal, OtherVersionsAreRefusedWithTheNumber) {
  const std::string newer = refusal(js("{'laplacian_edit': 3, 'poses': []}"));
  expect_contains(newer, "expected the number 1");
  expect_contains(newer, "the number 3");
  expect_contains(refusal(js("{'steps': []}")), "laplacian_edit: expected the number 1");
  expect_contains(refusal(js("{'laplacian_edit': '1'}")), "found the text \"1\"");
}

TEST(EditScriptRefusal, UnknownKeysAreRefusedByNameAndPlace) {
  EXPECT_EQ(refusal(with_steps("{'region': {'radius': 1}, 'handles': [{'vertices': '1'}]},"
                               "{'region': {'radius': 1}, 'handles': [{'vertices': '1', 'translaton': [0,0,1]}]}")),
            "steps[1].handles[0]: unknown key \"translaton\"; known keys are vertices, points, within, "
            "selected, landmarks, weights, targets, slide, translation, rotation, scale, matrix.");
  expect_contains(refusal(js("{'laplacian_edit': 1, 'step': []}")), "edit: unknown key \"step\"");
  expect_contains(refusal(with_mesh("{'edges': 1}")),
                  "mesh: unknown key \"edges\"; known keys are vertices, faces, connectivity, positions.");
  expect_contains(refusal(with_region("{'radius': 1, 'pad': 1}")), "steps[0].region: unknown key \"pad\"");
  expect_contains(refusal(with_setting("'Order': 1")), "steps[0]: unknown key \"Order\"");
  expect_contains(refusal(with_handle("{'vertices': '1', 'rotation': {'angle': 1}}")),
                  "steps[0].handles[0].rotation: unknown key \"angle\"; known keys are axis, degrees, center.");
  const std::string strange = refusal(js("{'laplacian_edit': 1, 'a\\nb\\u0007" + std::string(5000, 'x') + "': 1}"));
  expect_contains(strange, R"("a\nb\u0007xxx)");
  EXPECT_LT(strange.size(), 300U);
}

/// Each JSON, and a part of its refusal.
using Cases = std::vector<std::pair<std::string, std::string>>;

void expect_refusals(const std::string& before, const Cases& cases, std::string (*made)(const std::string&)) {
  for (const auto& [json, expected] : cases) {
    expect_contains(refusal(made(json)), before + expected);
  }
}

TEST(EditScriptRefusal, WrongTypesAreRefusedWithWhatWasExpected) {
  const std::string number = "a whole number from 0 to 2147483647, found",
                    some = "steps: expected a list of one or more ";
  const auto steps = [](const std::string& text) { return with_steps(text); };
  const auto mesh = [](const std::string& text) { return with_mesh(text); };
  expect_refusals("",
                  {{"[]", "it has to be a JSON object"},
                   {"{'laplacian_edit': 1}", some + "steps, but the key"},
                   {"{'laplacian_edit': 1, 'steps': {}}", some + "steps, found an object."}},
                  js);
  expect_refusals("steps",
                  {{"", ": expected a list of one or more steps, found a list of length 0"},
                   {"null", "[0]: expected an object, found null."},
                   {"{}", "[0].region: expected an object, but the key is missing."},
                   {"{'region': {'radius': 1}}", "[0].handles: expected a list of one or more"}},
                  steps);
  for (const char* region : {"{}", "{'padding': 0.1}", "{'radius': 1, 'vertices': '1'}",
                             "{'radius': 1, 'component': true}", "{'vertices': '1', 'component': true}"}) {
    EXPECT_EQ(refusal(with_region(region)),
              "steps[0].region: needs exactly one of the keys radius, vertices, component, within and selected.");
  }
  expect_refusals("steps[0].region",
                  {{"3", ": expected an object, found the number 3."},
                   {"{'within': {'point': [0, 0, 0], 'radius': 1}, 'anchors': {}}",
                    ".anchors: kept anchors go with the key vertices"},
                   {"{'component': false}", ".component: expected true, found false."},
                   {"{'component': 1}", ".component: expected true, found the number 1."},
                   {"{'radius': '20 %'}", ".radius: expected a number, found the text \"20 %\"."},
                   {"{'radius': 1, 'padding': []}", ".padding: expected a number, found a"}},
                  with_region);
  const std::string matrix = "'vertices': '1', 'matrix': [1,0,0,0, 0,1,0,0, 0,0,1,0";
  expect_refusals("steps[0].handles",
                  {{"", ": expected a list of one or more handle groups, found a list of length 0."},
                   {"7", "[0]: expected an object, found the number 7."},
                   {"{}", "[0]: needs exactly one of the keys vertices, points, within, selected and landmarks."},
                   {"{'vertices': '1', 'points': [[0, 0, 0]]}", "[0]: needs exactly one of the keys vertices, points,"},
                   {"{" + matrix + ", 0,0,0,1], 'scale': 1}", "[0]: has both matrix and "},
                   {"{" + matrix + ", 0,0,0,1], 'rotation': {}}", "[0]: has both matrix and "},
                   {"{" + matrix + ", 0,0,0,1], 'translation': [0, 0, 0]}", "[0]: has both matrix and "}},
                  with_handle);
  expect_refusals(
      "steps[0].handles[0].",
      {{"{'points': [0, 0, 1]}", "points[0]: expected a list of 3 numbers, found the number 0."},
       {"{'within': {'point': [0, 0, 0]}}", "within.radius: expected a number, but the key is missing."},
       {"{'selected': true, 'weights': [1]}", "weights: goes with vertices, points or landmarks only."},
       {"{'points': [[0, 0, 0]], 'weights': [1, 1]}", "weights: holds 2 numbers for 1 points; give one for each"},
       {"{'points': [[0, 0, 0], [1, 0, 0]], 'targets': [[0, 0, 1]]}",
        "targets: holds 1 targets for 2 points; give one for each"},
       {"{'selected': true, 'targets': [[0, 0, 1]]}", "targets: goes with points or vertices only"},
       {"{'landmarks': {'from': 'no.pp', 'to': 'no.pp'}}", "landmarks: \"no.pp\" is not the path of a file."},
       {"{'landmarks': {'from': 'no.pp'}}", "landmarks.to: expected a text, but the key is missing."},
       {"{'vertices': true}", "vertices: expected vertices, as in \"12-40,77\" or [12, 77], found true."},
       {"{'selected': 1}", "selected: expected true, found the number 1."},
       {"{'vertices': []}", "vertices: expected vertices, as in \"12-40,77\" or [12, 77], found a list of length 0."},
       {"{'vertices': [1, 2.5]}", "vertices[1]: expected " + number + " the number 2.5."},
       {"{'vertices': [1, '2;3']}", "vertices[1]: \"2;3\" is no vertex number or range"},
       {"{'vertices': '1', 'translation': 1}", "translation: expected a list of 3 numbers, found the number 1."},
       {"{'vertices': '1', 'rotation': 30}", "rotation: expected an object, found the number 30."},
       {"{'vertices': '1', 'rotation': {'center': null}}",
        "rotation.center: expected a list of 3 numbers, found null."},
       {"{'vertices': '1-2', 'targets': [[0, 0, 1], [1, 2]]}",
        "targets[1]: expected a list of 3 numbers, found a list"},
       {"{" + matrix + "]}", "matrix: expected a list of 16 numbers, found a"},
       {"{" + matrix + ", 0,0,0,2]}", "matrix: the last row"},
       {"{" + matrix + ", 0,1,0,1]}", "matrix: the last row"}},
      with_handle);
  for (const std::string other : {"scale", "rotation", "translation", "matrix"}) {
    EXPECT_EQ(refusal(with_handle("{'vertices': '1', 'targets': [[0, 0, 1]], '" + other + "': 1}")),
              "steps[0].handles[0]: has both targets and " + other + "; remove one of the two.");
  }
  const std::string meaning = ": has no meaning with the method ";
  expect_refusals(
      "steps[0].",
      {{"'weld': false", "weld: can no longer be switched off, since"},
       {"'laplacian': 'uniform'",
        "laplacian: expected one of \"umbrella\", \"cotangent\", \"mean_value\", \"surface\", "
        "found the text \"uniform\"."},
       {"'normal_radius': 1", "normal_radius" + meaning + "default; remove it, or use the method paper."},
       {"'method': 'paper', 'iterations': 2", "iterations" + meaning + "paper; remove it, or use the method default."},
       {"'method': 'linear', 'rough': 'falloff'", "rough" + meaning + "linear; remove it, or use the method paper."},
       {"'order': 1.5", "order: expected " + number + " the number 1.5."},
       {"'iterations': 2147483648", "iterations: expected " + number},
       {"'handle_weight': {}", "handle_weight: expected a number, found an object."}},
      with_setting);
  EXPECT_EQ(refusal(with_setting("'weld': true")), "") << "of version 1.0";
  expect_refusals("mesh",
                  {{"3", ": expected an object, found the number 3."},
                   {"{'vertices': -3}", ".vertices: expected a whole number from 0 to"},
                   {"{'faces': 0.5}", ".faces: expected a whole number from 0 to"},
                   {"{'connectivity': 7}", ".connectivity: expected a text, found the number 7."},
                   {"{'positions': {'vertices': '3,1', 'points': [[0, 0, 0], [1, 0, 0]]}}",
                    ".positions.vertices: vertex 1 comes after 3; put them in ascending order, each once."},
                   {"{'positions': {'vertices': '1,3', 'points': [[0, 0, 0]]}}",
                    ".positions.vertices: lists 2 vertices, but mesh.positions has points for 1; give one for each."}},
                  mesh);
  for (const char* checksum : {"", "0123456789abcde", "0123456789abcdef0", "0123456789ABCDEF", "0123456789abcdeg"}) {
    expect_contains(refusal(with_mesh(std::string("{'connectivity': '") + checksum + "'}")),
                    "mesh.connectivity: expected a checksum of 16 digits");
  }
}

TEST(EditScriptRefusal, VertexListsTakeSpacesAndKeepOrder) {
  const auto vertices = [](const char* ranges) { return read_edit(with_ranges(ranges)).steps[0].handles[0].vertices; };
  EXPECT_EQ(vertices("7"), std::vector<int>{7});
  EXPECT_EQ(vertices("9,2-4,2"), (std::vector<int>{9, 2, 3, 4, 2}));
  EXPECT_EQ(vertices(" 2 - 3 ,\\t5 , 0\\n"), (std::vector<int>{2, 3, 5, 0}));
  EXPECT_EQ(vertices("5-5"), std::vector<int>{5});
  EXPECT_EQ(vertices("2147483646-2147483647"), (std::vector<int>{2147483646, 2147483647}));
  const auto listed = [](const char* list) {
    return read_edit(with_handle(std::string("{'vertices': ") + list + "}")).steps[0].handles[0].vertices;
  };
  EXPECT_EQ(listed("[312, 7]"), (std::vector<int>{312, 7}));
  EXPECT_EQ(listed("[3, '9,2-4', 0]"), (std::vector<int>{3, 9, 2, 3, 4, 0}));
  EXPECT_EQ(listed("8"), std::vector<int>{8});
}

TEST(EditScriptRefusal, BadVertexListsAreRefusedWithTheOffendingText) {
  const auto expect_refused = [](const char* ranges, const std::string& offender) {
    const std::string sentence = refusal(with_ranges(ranges));
    expect_contains(sentence, "steps[0].handles[0].vertices: \"" + offender + "\" is no vertex number or range");
  };
  for (const char* ranges : {"", " ", "-5", "1-2-3", "4-", "1 2", "1-x", "all", "1.5", "1e3", "+1", "0x10", "1;2",
                             "4--2", "1\\u0000", "\u00A01", "2147483648", "0-99999999999999999999"}) {
    expect_refused(ranges, ranges);
  }
  for (const char* ranges : {"1,", ",1", "1,,2"}) {
    expect_refused(ranges, "");
  }
  expect_refused("3,-5", "-5");
  expect_refused("1-x,2", "1-x");
  expect_contains(refusal(with_ranges("1,40-12")), "\"40-12\" is a range from high to low");
  expect_contains(refusal(with_region("{'vertices': ''}")), "steps[0].region.vertices: \"\" is no vertex number");
}

TEST(EditScriptRefusal, VertexListsFitTheMeshThatTheEditNames) {
  EXPECT_EQ(refusal(with_mesh("{'vertices': 100}", "0-99")), "");
  const std::string outside = refusal(with_mesh("{'vertices': 100}", "3,90-100"));
  expect_contains(outside, "vertex 100 ");
  expect_contains(outside, "has 100 vertices");
  expect_contains(refusal(with_mesh("{'vertices': 100}", "3,90-200")), "vertex 100 ");
  EXPECT_EQ(refusal(with_mesh("{'vertices': 100}", "0-99,5")), "") << "a set is a set";
}

TEST(EditScriptRefusal, VertexListsTakeNoMoreMemoryThanTheMesh) {
  const TriangleMesh mesh = {Points::Zero(1000, 3), Faces(0, 3)};
  const auto read = [&mesh](const std::string& text) { return read_edit(js(text), {}, &mesh); };
  const auto step = [](const std::string& region, const std::string& fit, const std::string& mesh_key = "") {
    return "{'laplacian_edit': 1, " + mesh_key + "'steps': [{'region': {'vertices': " + region + ", 'held': " + region +
           "}, 'fit': {'to': 'a.ply', 'exclude': {'vertices': " + fit + "}}}]}";
  };
  std::string repeated = "'0-999";
  for (int k = 0; k < 9000; ++k) {
    repeated += ",0-999";
  }
  repeated += "'";
  largest_allocation = 0;
  const Edit edit = read(step(repeated, repeated));
  EXPECT_LT(largest_allocation, 5 * repeated.size()) << "the text and its ranges";
  EXPECT_EQ(edit.steps[0].region.vertices.size(), 1000U);
  EXPECT_EQ(edit.steps[0].region.held.size(), 1000U);
  EXPECT_EQ(edit.steps[0].fit->exclude.size(), 1000U);

  largest_allocation = 0;
  const std::string inside = "'1,2'", beyond = "'5,10-99999999'", by_position = "'mesh': {'positions': {'vertices': ";
  for (const std::string& text :
       {step(beyond, inside), step(inside, beyond), step("[5, 1000]", inside), step("['0-99999999']", inside)}) {
    expect_contains(refusal_of([&] { read(text); }),
                    "vertex 1000 is outside the edit's mesh, which has 1000 vertices, counted from 0.");
  }
  try {
    read(step(beyond, inside, "'mesh': {'vertices': 100000000}, "));
    ADD_FAILURE() << "was read";
  } catch (const EditError& error) {
    EXPECT_EQ(error.cause(), ErrorCause::MeshMismatch);
    expect_contains(error.what(), "The edit was made for a mesh of 100000000 vertices");
  }
  expect_contains(refusal_of([&] { read(step(beyond, inside, by_position + "'7', 'points': [[0, 0, 0]]}}, ")); }),
                  "vertex 10 is not among mesh.positions, by which the edit is applied; add it.");
  const std::string typo = step(beyond, inside + "}, 'typo': {'to': 1");
  expect_contains(refusal_of([&] { read(typo); }), "unknown key \"typo\"");
  const std::string high = by_position + "[99999999], 'points': [[0, 0, 0]]}}, ";
  expect_contains(refusal_of([&] { read(step(beyond, inside, high)); }),
                  "lists 99999991 vertices, but mesh.positions has points for 1; give one for each.");
  expect_contains(
      refusal_of([&] { read(step(inside, inside, by_position + "'0-99999999', 'points': [[0, 0, 0]]}}, ")); }),
      "lists 100000000 vertices, but mesh.positions has points for 1; give one for each.");
  EXPECT_LT(largest_allocation, 100000U);
}

TEST(EditScriptRefusal, WrongStepsTakeNoMoreMemoryThanTheirText) {
  std::string steps = "[]";
  for (int k = 1; k < 100000; ++k) {
    steps += ",[]";
  }
  const std::string edit = with_steps(steps), group = with_handle(steps);
  largest_allocation = 0;
  expect_contains(refusal(edit), "steps[0]: expected an object, found a list of length 0.");
  expect_contains(refusal(group), "steps[0].handles[0]: expected an object, found a list of length 0.");
  EXPECT_LT(largest_allocation, 10 * edit.size());
}

TEST(EditScriptRefusal, HostileVertexListsTakeNoMemory) {
  largest_allocation = 0;
  expect_contains(refusal(with_ranges("0-2147483647")), "may list 100000000");
  expect_contains(refusal(with_ranges("0-60000000,40000000-120000000")), "may list 100000000");
  expect_contains(refusal(with_mesh("{'vertices': 2147483647}", "0-2147483647")), "is outside the edit's mesh");
  expect_contains(refusal(with_mesh("{'vertices': 2147483647}", "0-2147483646")), "may list 100000000");
  EXPECT_LT(largest_allocation, 100000U);
}

TEST(EditScriptRefusal, VertexListsAreLimitedTogether) {
  const std::string group = "{'vertices': '0-29999999'}";  // 120 MB when read
  const std::string sentence = refusal(with_handle(group + "," + group + "," + group + "," + group));
  expect_contains(sentence, "steps[0].handles[3].vertices: ");
  expect_contains(sentence, "120000000");
}

TEST(EditScriptRefusal, EveryPrefixIsRefused) {
  const std::string example = kExample, whole = example.substr(0, example.find_last_not_of('\n') + 1);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    ASSERT_NE(refusal(whole.substr(0, length)), "") << length;
  }
  EXPECT_EQ(refusal(whole), "");
}

TEST(EditScriptRefusal, HugeFilesAreNotRead) {
  const std::string path = testing::TempDir() + "/lapedit_huge.json";
  std::ofstream(path).close();
  std::filesystem::resize_file(path, std::uintmax_t(1) << 36);  // holds no data
  largest_allocation = 0;
  try {
    load_edit(path);
    FAIL() << "was read";
  } catch (const EditError& error) {
    expect_contains(error.what(), "68719476736 bytes; the limit is 67108864");
  }
  EXPECT_LT(largest_allocation, 1000000U);
  std::filesystem::remove(path);
}

std::string parse_refusal(const std::string& json) {
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
    expect_contains(parse_refusal(text), expected);
  }
  for (const char* empty : {"", " \n\t", "\xEF\xBB\xBF"}) {
    expect_contains(parse_refusal(empty), "empty");
  }
  expect_contains(parse_refusal("[]"), "a list of length 0; it has to be a JSON object");
}

TEST(JsonObject, ByteOrderMarkIsSkipped) {
  EXPECT_EQ(parse_refusal("\xEF\xBB\xBF{\"a\": 1}"), "");
}

TEST(JsonObject, RepeatedKeysAreRefusedWithTheirLocation) {
  EXPECT_EQ(parse_refusal(R"({"b": [], "b": []})"),
            "edit: the key \"b\" is given twice in one object; keep one of the two.");
  expect_contains(parse_refusal(R"({"\u0061b": 1, "ab": 2})"), "the key \"ab\"");
  expect_contains(parse_refusal(R"({"x": [1, {"a": {"b":1, "b":2}}]})"), "x[1].a: the key \"b\"");
  expect_contains(parse_refusal(R"({"a": {}, "b": 1, "a": {}})"), "the key \"a\"");
  EXPECT_EQ(parse_refusal(R"({"a": [{"a": 1}, {"a": 1}], "b": {"a": "a"}})"), "");
  EXPECT_EQ(parse_refusal(R"({"a": "\":\"", "b": "\":\""})"), "");
  EXPECT_EQ(parse_refusal(R"({"a": "\"{}]: \\", "b": "\\\"", "c": ["a", "a"]})"), "");
}

TEST(JsonObject, DeepNestingIsRefused) {
  for (const std::size_t depth : {1025, 1000000}) {
    expect_contains(parse_refusal("{\"a\":" + std::string(depth, '[')), "more than 1024 deep");
    std::string objects;
    for (std::size_t i = 0; i < depth; ++i) objects += "{\"a\":";
    expect_contains(parse_refusal(objects), "more than 1024 deep");
  }
}

TEST(JsonObject, ObjectsWithManyKeysAreRefused) {
  std::string keys = "\"k\": 1";
  for (int k = 0; k < 99; ++k) keys += ", \"k" + std::to_string(k) + "\": 1";
  EXPECT_EQ(parse_refusal("{" + keys + "}"), "");
  expect_contains(parse_refusal("{\"a\": [{" + keys + ", \"b\": 1}]}"), "a[0]: the object has more than 100 keys");
}

TEST(JsonObject, HugeTextsAreRefused) {
  expect_contains(parse_refusal(std::string((64 << 20) + 1, ' ')), "67108865 bytes; the limit is 67108864");
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
}  // namespace lapedit::edit_script_refusal_test
