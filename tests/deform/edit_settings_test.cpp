// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_settings.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"

namespace lapedit {
namespace {

std::string refusal(const EditSettings& settings) {
  try {
    validate(settings);
    return "";
  } catch (const EditError& error) {
    EXPECT_EQ(error.cause(), ErrorCause::BadParameter);
    return error.what();
  }
}

TEST(EditSettings, EverySettingIsRefusedOutsideItsRangeOnly) {
  for (const Setting& setting : settings_table()) {
    const auto with = [&](double value) {
      EditSettings settings;
      setting.set(settings, value);
      EXPECT_EQ(setting.get(settings), value) << setting.key;
      return refusal(settings);
    };
    const bool real = setting.kind == Setting::Kind::Length || setting.kind == Setting::Kind::Number;
    const double step = real ? 1e-7 : 1;
    EXPECT_EQ(with(setting.low), "");
    EXPECT_EQ(with(setting.high), "");
    EXPECT_EQ(with(setting.low - step), std::string("The ") + setting.subject + " is " +
                                            number_text(setting.low - step) + ": give " + setting.range + ".");
    EXPECT_NE(with(setting.kind == Setting::Kind::Length ? std::numeric_limits<double>::infinity() : setting.high + 1),
              "");
    if (real) {
      EditSettings settings;
      setting.set(settings, std::numeric_limits<double>::quiet_NaN());
      EXPECT_NE(refusal(settings), "") << setting.key;
    }
  }
}

TEST(EditSettings, AreEqualWhereEverySettingIs) {
  const EditSettings standard;
  EXPECT_EQ(refusal(standard), "");
  EXPECT_EQ(standard, EditSettings());
  for (const Setting& setting : settings_table()) {
    EditSettings other;
    setting.set(other, setting.get(standard) == setting.low ? setting.low + 1 : setting.low);
    EXPECT_NE(other, standard) << setting.key;
  }
  EditSettings other;
  other.threads = 1;
  EXPECT_NE(other, standard);
  other = standard;
  other.rules = 1;
  EXPECT_NE(other, standard);
  other = standard;
  other.backend = CholeskyBackend::Eigen;
  EXPECT_NE(other, standard);
}

TEST(EditSettings, ChoicesHaveOneNameForEachNumber) {
  for (const Setting& setting : settings_table()) {
    const std::size_t names = setting.kind == Setting::Kind::Choice ? static_cast<std::size_t>(setting.high) + 1 : 0;
    EXPECT_EQ(setting.choices.size(), names) << setting.key;
  }
  EXPECT_EQ(title_of("smooth_normals"), "Smooth normals");
}

/// All documents of the project.
std::string documents() {
  namespace fs = std::filesystem;
  std::ostringstream text;
  const auto add = [&](const fs::path& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".md") {
        text << std::ifstream(entry.path()).rdbuf() << '\n';
      }
    }
  };
  for (const char* folder : {"", "filter_laplacian_edit", "edit_laplacian_drag", "common/docs"}) {
    add(fs::path(LAPEDIT_SOURCE_DIR) / folder);
  }
  return text.str();
}

TEST(EditSettings, DocumentsListEveryParameterWithItsDefault) {
  const std::string text = documents();
  const char* const types[] = {"RichEnum", "RichInt", "RichAbsPerc", "RichFloat"};  // by kind
  for (const Setting& setting : settings_table()) {
    const std::string row = std::string("| `") + setting.key + "` | " + types[static_cast<int>(setting.kind)] + " | " +
                            number_text(setting.get(EditSettings())) + " |";
    EXPECT_NE(text.find(row), std::string::npos) << row;
    for (const char* choice : setting.choices) {
      EXPECT_NE(text.find(std::string("`") + choice + "`"), std::string::npos) << choice;
    }
  }
}

}  // namespace
}  // namespace lapedit
