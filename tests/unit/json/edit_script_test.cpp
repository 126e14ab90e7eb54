// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/edit_script.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "lapedit/base/error.h"
#include "lapedit/json/landmarks.h"
#include "script_support.h"
#include "temporary_folder.h"

namespace lapedit::edit_script_test {
namespace {

bool same(const HandleTransform& a, const HandleTransform& b) {
  if (a.matrix || b.matrix) {
    return a.matrix && b.matrix && *a.matrix == *b.matrix;
  }
  return a.translation == b.translation && a.axis == b.axis && a.degrees == b.degrees &&
         a.center.has_value() == b.center.has_value() && (!a.center || *a.center == *b.center) && a.scale == b.scale;
}

bool same(const EditStep& a, const EditStep& b) {
  const bool component = a.region.kind == RegionSpec::Kind::Component;
  return a.region.kind == b.region.kind && a.region.radius == b.region.radius &&
         a.region.vertices == b.region.vertices && (component || a.region.padding == b.region.padding) &&
         a.settings == b.settings && a.region.connect_gap == b.region.connect_gap && a.region.tips == b.region.tips &&
         a.region.pieces == b.region.pieces && a.mirror.has_value() == b.mirror.has_value() &&
         (!a.mirror || (a.mirror->point == b.mirror->point && a.mirror->normal == b.mirror->normal)) &&
         std::equal(a.handles.begin(), a.handles.end(), b.handles.begin(), b.handles.end(),
                    [](const HandleGroup& g, const HandleGroup& h) {
                      return g.vertices == h.vertices && g.weights == h.weights && g.targets == h.targets &&
                             same(g.transform, h.transform);
                    });
}

bool same(const Edit& a, const Edit& b) {
  return a.mesh_vertices == b.mesh_vertices && a.mesh_faces == b.mesh_faces && a.connectivity == b.connectivity &&
         std::equal(a.steps.begin(), a.steps.end(), b.steps.begin(), b.steps.end(),
                    [](const EditStep& s, const EditStep& t) { return same(s, t); });
}

/// Any finite double but -0, all exponents alike: equal ones have the same bits.
double any_double(std::mt19937_64& random) {
  for (;;) {
    const std::uint64_t bits = random();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    if (std::isfinite(value) && !(value == 0 && std::signbit(value))) {
      return value;
    }
  }
}

TEST(EditScript, ReadsMatrixByRows) {
  const auto matrix = read_edit(R"({"laplacian_edit": 1, "steps": [{"region": {"radius": 1}, "handles":
          [{"vertices": "1", "matrix": [1,2,3,4, 5,6,7,8, 9,10,11,12, 0,0,0,1]}]}]})")
                          .steps[0]
                          .handles[0];
  EXPECT_EQ((*matrix.transform.matrix)(0, 3), 4);
  EXPECT_EQ((*matrix.transform.matrix)(2, 0), 9);
}

TEST(EditScript, AbsentKeysTakeTheDefaults) {
  EditStep expected;
  expected.region.radius = 1;
  expected.handles = {{{1}, {}}};
  const Edit edit =
      read_edit(R"({"laplacian_edit": 1, "steps": [{"region": {"radius": 1}, "handles": [{"vertices": "1"}]}]})");
  ASSERT_EQ(edit.steps.size(), 1U);
  EXPECT_TRUE(same(edit.steps[0], expected));
  EXPECT_FALSE(edit.mesh_vertices);
  EXPECT_FALSE(edit.mesh_faces);
  EXPECT_EQ(edit.connectivity, "");
}

/// And in the documented order. Keys that are not used, or have no meaning with the method, are not written.
TEST(EditScript, EveryKeyIsWrittenAsItWasRead) {
  const std::string step = R"({"laplacian_edit":1,"steps":[{"region":)", soft = R"("weights":[1,0.5,0.003],)",
                    turn = R"("rotation":{"axis":[0,0,1],"degrees":0},"scale":1})",
                    settings = R"("method":"default","laplacian":"surface","order":1,"membrane":500,)"
                               R"("handle_weight":30,"anchor_weight":30,"detail":1,"iterations":0)";
  const std::string texts[] = {
      R"({"laplacian_edit":1,"mesh":{"vertices":11703},"steps":[{"region":{"radius":1.2155,"padding":0.1},"handles":[)"
      R"({"vertices":"12-14,77,9-10,9","translation":[0,-0.9,0.3333333333333333],)" +
          turn +
          R"(],"method":"paper","laplacian":"cotangent","order":1,"membrane":7.5,"handle_weight":10,)"
          R"("anchor_weight":10,"detail":1,"normal_radius":0,"rough":"falloff"}]})",
      step + R"({"component":true,"connect":0.02,"tips":true,"pieces":true},"handles":[{"vertices":"9,3-4",)" + soft +
          R"("translation":[0,0,1],)" + turn + R"(],"mirror":{"point":[0,0.5,0],"normal":[1,0,0]},)" + settings +
          R"(,"contact":true}]})",
      R"({"laplacian_edit":1,"mesh":{"positions":{"vertices":"3,7-8","points":[[0,0,1],[0.5,0,1e-07],[1,2,3]]}},)"
      R"("steps":[{"region":{"within":{"point":[1,2,3],"radius":0.5},"padding":0.1},"handles":[)"
      R"({"points":[[1,2,3]],"targets":[[4,5,6]]},{"points":[[1,2,3],[0.1,0,0],[7,8,9]],)" +
          soft + R"("translation":[0,0,1],)" + turn +
          R"(,{"within":{"point":[0,0,1],"radius":2},"translation":[0,0,0],)" + turn + R"(],)" + settings + "}]}",
      step + R"({"selected":true,"padding":0.1},"handles":[{"selected":true,"translation":[0,0,0],)" + turn + "]," +
          settings + "}]}",
      step +
          R"({"component":true},"fit":{"to":"scan.ply","mode":"pose","align":"none","detail":0.05,"distance":2,)"
          R"("accuracy":0.25,"borders":true,"exclude":{"vertices":"12-14"}},"handles":[)"
          R"({"points":[[0,0,1]],"targets":[[0,1,1]],"slide":0.2}],)" +
          settings + "}]}"};
  for (const std::string& text : texts) {
    std::string written = write_edit(read_edit(text));
    EXPECT_GT(std::count(written.begin(), written.end(), '\n'), 20);
    written.erase(std::remove_if(written.begin(), written.end(), [](char c) { return c == ' ' || c == '\n'; }),
                  written.end());
    EXPECT_EQ(written, text);
  }
  EXPECT_TRUE(read_edit(texts[2]).by_position());
}

TEST(EditScript, RoundTripKeepsEveryBit) {
  std::mt19937_64 random(1);
  const auto vector = [&] { return Vector3(any_double(random), any_double(random), any_double(random)); };
  Edit edit = read_edit(kExample);
  edit.steps[1].handles[0].targets.resize(1);
  for (int round = 0; round < 2000; ++round) {
    edit.steps[0].region.radius = any_double(random);
    for (EditStep& step : edit.steps) {
      step.region.padding = any_double(random);
      for (HandleGroup& handle : step.handles) {
        HandleTransform& transform = handle.transform;
        if (!handle.targets.empty()) {
          handle.targets[0] = vector();
          continue;
        }
        transform.translation = vector();
        transform.axis = vector();
        transform.degrees = any_double(random);
        transform.scale = any_double(random);
        for (int i = 0; transform.matrix && i < 12; ++i) transform.matrix->data()[i] = any_double(random);
        if (transform.center) transform.center = vector();
      }
      for (const Setting& setting : settings_table()) {
        const bool real = setting.kind == Setting::Kind::Length || setting.kind == Setting::Kind::Number;
        if (real && setting.applies(step.settings.method)) setting.set(step.settings, any_double(random));
      }
    }
    const std::string text = write_edit(edit);
    ASSERT_TRUE(same(read_edit(text), edit)) << text;
    ASSERT_EQ(write_edit(read_edit(text)), text);
  }
}

TEST(EditScript, SwitchesCanHaveTheirDefault) {
  const auto script = [](const char* in_region, const char* in_fit, const char* in_step) {
    return std::string(R"({"laplacian_edit": 1, "steps": [{"region": {"radius": 1)") + in_region +
           R"(}, "handles": [{"vertices": "3"}])" + in_step +
           R"(}, {"region": {"component": true}, "fit": {"to": "a.ply")" + in_fit + "}}]}";
  };
  const Edit plain = read_edit(script("", "", ""));
  EXPECT_TRUE(
      same(read_edit(script(R"(, "tips": false, "pieces": false)", R"(, "borders": false)", R"(, "contact": false)")),
           plain));
  EXPECT_FALSE(same(read_edit(script(R"(, "tips": true)", "", "")), plain));
}

TEST(EditScript, WritingRefusesWhatCouldNotBeRead) {
  const Edit good = read_edit(kExample);
  const auto cause = [&](const auto& spoil) {
    Edit edit = good;
    spoil(edit);
    try {
      write_edit(edit);
    } catch (const EditError& error) {
      return error.cause();
    }
    return ErrorCause::Cancelled;
  };
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(cause([](Edit& e) { e.steps[0].region.radius = kNaN; }), ErrorCause::NotFinite);
  EXPECT_EQ(cause([](Edit& e) { e.steps[0].handles[0].transform.translation[1] = -kInfinity; }), ErrorCause::NotFinite);
  EXPECT_EQ(cause([=](Edit& e) { e.steps[0].handles[0].targets.emplace_back(0, 0, kInfinity); }),
            ErrorCause::NotFinite);
  EXPECT_EQ(cause([](Edit& e) { (*e.steps[0].handles[2].transform.matrix)(2, 3) = kNaN; }), ErrorCause::NotFinite);
  EXPECT_EQ(cause([](Edit& e) { e.steps[0].settings.anchor_weight = kInfinity; }), ErrorCause::NotFinite);
  EXPECT_EQ(cause([](Edit& e) { e.steps.clear(); }), ErrorCause::BadScript);
  EXPECT_EQ(cause([](Edit& e) { e.steps[0].handles.clear(); }), ErrorCause::BadScript);
  EXPECT_EQ(cause([](Edit& e) { e.steps[1].handles[0].vertices.clear(); }), ErrorCause::BadScript);
  EXPECT_EQ(cause([](Edit& e) { e.steps[1].handles[0].vertices = {3, -1}; }), ErrorCause::BadScript);
  EXPECT_EQ(cause([](Edit& e) { e.steps[1].handles[0].vertices = {11703}; }), ErrorCause::BadScript);
  EXPECT_EQ(cause([](Edit& e) { e.steps[1].settings.order = -1; }), ErrorCause::BadScript);
  EXPECT_EQ(cause([](Edit& e) { e.steps[1].settings.method = static_cast<EditMethod>(7); }), ErrorCause::BadScript);
}

class EditFile : public TemporaryFolder {
 protected:
  static std::string refusal(const std::string& text_or_path) {
    return refusal_of([&] { load_edit(text_or_path); });
  }
};

TEST_F(EditFile, TextAndPathGiveTheSameEdit) {
  const Edit expected = read_edit(kExample);
  EXPECT_TRUE(same(load_edit(kExample), expected));
  EXPECT_TRUE(same(load_edit(std::string(" \n\t") + kExample), expected));
  EXPECT_TRUE(same(load_edit(std::string("\xEF\xBB\xBF") + kExample), expected));
  EXPECT_TRUE(same(load_edit(write("edit.json", kExample)), expected));
  EXPECT_TRUE(same(load_edit(" " + write("\xC3\xA4 b.json", kExample) + "\n"), expected));
  EXPECT_TRUE(same(load_edit(write("bom.json", std::string("\xEF\xBB\xBF") + kExample)), expected));
}

TEST_F(EditFile, UnusablePathsAreRefusedByName) {
  expect_contains(refusal(""), "No edit is given");
  expect_contains(refusal("  "), "No edit is given");
  expect_contains(refusal("no/such.json"), "\"no/such.json\" is neither JSON text");
  expect_contains(refusal(folder_), "is neither JSON text");
  expect_contains(refusal("[1]"), "\"[1]\" is neither JSON text");
  expect_contains(refusal("/dev/zero"), "is neither JSON text");
  const std::string inside = refusal(write("bad.json", "{\n\"laplacian_edit\" 1}"));
  expect_contains(inside, "bad.json\": The text is not valid JSON: parse error at line 2, column ");
}

Edit read_step(const std::string& step) {
  return read_edit(R"({"laplacian_edit": 1, "steps": [{"region": {"component": true}, )" + step + "}]}");
}

std::string refusal(const std::string& step) {
  return refusal_of([&] { read_step(step); });
}

TEST(FitJson, NeedsNoHandles) {
  const Edit edit = read_step(R"("fit": {"to": "scan.ply"})");
  EXPECT_TRUE(edit.steps[0].handles.empty());
  EXPECT_FALSE(edit.steps[0].fit->settings.align.has_value());
  EXPECT_FALSE(edit.steps[0].fit->settings.accuracy.has_value());
  EXPECT_EQ(write_edit(read_edit(write_edit(edit))), write_edit(edit));
  EXPECT_EQ(write_edit(read_step(R"("fit": {"to": "scan.ply"}, "handles": [])")), write_edit(edit));
  EXPECT_NE(write_edit(fit_scan("a.ply")).find("\"to\": \"a.ply\""), std::string::npos);
}

TEST(FitJson, RefusesWhatHasNoMeaning) {
  const std::string fit = R"("fit": {"to": "a.ply")",
                    marks = R"("handles": [{"points": [[0, 0, 1]], "targets": [[0, 1, 1]], )";
  const std::pair<std::string, const char*> cases[] = {
      {fit + R"(, "mode": "both"})", "\"shape\""},
      {fit + R"(, "align": 3})", "align"},
      {fit + R"(, "exclude": "3"})", "exclude"},
      {fit + R"(}, "handles": [{"vertices": "3", "translation": [0, 0, 1]}])", "no targets"},
      {marks + R"("slide": 0.2}])", "slide"},
      {fit + "}, " + marks + R"("slide": 2}])", "slide"},
      {R"("mirror": {"point": [0, 0, 0], "normal": [1, 0, 0]})", "handles"},
      {R"("handles": [])", "one or more handle groups"}};
  for (const auto& [step, part] : cases) {
    expect_contains(refusal(step), part);
  }
}

}  // namespace
}  // namespace lapedit::edit_script_test
