// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "lapedit/base/error.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/json/landmarks.h"

namespace lapedit::fit_json_test {
namespace {

Edit read_step(const std::string& step) {
  return read_edit(R"({"laplacian_edit": 1, "steps": [{"region": {"component": true}, )" + step + "}]}");
}

std::string refusal(const std::string& step) {
  try {
    read_step(step);
  } catch (const EditError& error) {
    return error.what();
  }
  return {};
}

TEST(FitJson, IsReadAndWritten) {
  const Edit edit = read_step(R"("fit": {"to": "scan.ply", "mode": "pose", "align": "none", "detail": 0.05,
                                          "distance": 2, "accuracy": 0.25, "borders": true, "exclude": {"vertices": "12-14"}},
                                  "handles": [{"points": [[0, 0, 1]], "targets": [[0, 1, 1]], "slide": 0.2}])");
  const std::string text = write_edit(edit);
  for (const Edit& each : {edit, read_edit(text)}) {
    const EditStep& step = each.steps.at(0);
    ASSERT_TRUE(step.fit.has_value());
    EXPECT_EQ(step.fit->to, "scan.ply");
    EXPECT_EQ(step.fit->settings.mode, FitMode::Pose);
    EXPECT_EQ(step.fit->settings.align, FitAlign::None);
    EXPECT_EQ(step.fit->settings.detail, 0.05);
    EXPECT_EQ(step.fit->settings.distance, 2);
    EXPECT_EQ(step.fit->settings.accuracy, 0.25);
    EXPECT_TRUE(step.fit->settings.borders);
    EXPECT_EQ(step.fit->exclude, std::vector<int>({12, 13, 14}));
    EXPECT_EQ(step.handles.at(0).slide, 0.2);
  }
  EXPECT_EQ(write_edit(read_edit(text)), text);
}

TEST(FitJson, NeedsNoHandles) {
  const Edit edit = read_step(R"("fit": {"to": "scan.ply"})");
  EXPECT_TRUE(edit.steps[0].handles.empty());
  EXPECT_FALSE(edit.steps[0].fit->settings.align.has_value());
  EXPECT_FALSE(edit.steps[0].fit->settings.accuracy.has_value());
  EXPECT_EQ(write_edit(read_edit(write_edit(edit))), write_edit(edit));
  EXPECT_EQ(write_edit(read_step(R"("fit": {"to": "scan.ply"}, "handles": [])")), write_edit(edit));
  EXPECT_NE(refusal(R"("handles": [])").find("one or more handle groups"), std::string::npos);
  EXPECT_NE(write_edit(fit_scan("a.ply")).find("\"to\": \"a.ply\""), std::string::npos);
}

TEST(FitJson, RefusesWhatHasNoMeaning) {
  EXPECT_NE(refusal(R"("fit": {"to": "a.ply", "mode": "both"})").find("\"shape\""), std::string::npos);
  EXPECT_NE(refusal(R"("fit": {"to": "a.ply", "align": 3})").find("align"), std::string::npos);
  EXPECT_NE(refusal(R"("fit": {"to": "a.ply", "exclude": "3"})").find("exclude"), std::string::npos);
  EXPECT_NE(
      refusal(R"("fit": {"to": "a.ply"}, "handles": [{"vertices": "3", "translation": [0, 0, 1]}])").find("no targets"),
      std::string::npos);
  EXPECT_NE(refusal(R"("handles": [{"points": [[0, 0, 1]], "targets": [[0, 1, 1]], "slide": 0.2}])").find("slide"),
            std::string::npos);
  EXPECT_NE(refusal(R"("fit": {"to": "a.ply"}, "handles": [{"points": [[0, 0, 1]], "targets": [[0, 1, 1]],
                       "slide": 2}])")
                .find("slide"),
            std::string::npos);
  EXPECT_NE(refusal(R"("mirror": {"point": [0, 0, 0], "normal": [1, 0, 0]})").find("handles"), std::string::npos);
}

}  // namespace
}  // namespace lapedit::fit_json_test
