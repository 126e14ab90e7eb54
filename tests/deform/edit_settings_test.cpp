// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_settings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

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

/// Recorded edits and scripts name these; keys, choices and their numbers never change, new ones go to the end.
TEST(EditSettings, KeysAndChoicesStayInTheirOrder) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> expected = {
      {"laplacian", {"umbrella", "cotangent", "mean_value"}},
      {"order", {}},
      {"detail_rotation", {"none", "smooth_normals", "smooth_surface", "local_global"}},
      {"iterations", {}},
      {"normal_radius", {}},
      {"handle_weight", {}},
      {"anchor_weight", {}},
      {"turning", {"vertex", "edge"}},
      {"rough", {"unrotated", "falloff"}},
      {"membrane", {}}};
  ASSERT_GE(settings_table().size(), expected.size());
  for (std::size_t row = 0; row < expected.size(); ++row) {
    const Setting& setting = settings_table()[row];
    EXPECT_EQ(setting.key, expected[row].first);
    ASSERT_EQ(setting.choices.size(), expected[row].second.size()) << setting.key;
    for (std::size_t choice = 0; choice < setting.choices.size(); ++choice) {
      EXPECT_EQ(setting.choices[choice], expected[row].second[choice]);
    }
  }
}

/// Fails if a number of the table stands for another choice in the code.
TEST(EditSettings, ChoicesAreWhatTheirNamesSay) {
  const auto setting = [](const char* key) {
    for (const Setting& one : settings_table()) {
      if (std::string(one.key) == key) {
        return one;
      }
    }
    throw std::out_of_range(key);
  };
  const auto plain = [](std::string text) {  // a name of a report against a choice of JSON
    std::replace(text.begin(), text.end(), ' ', '_');
    std::replace(text.begin(), text.end(), '-', '_');
    return text;
  };
  const auto check = [&](const char* key, auto member) {
    const Setting row = setting(key);
    for (std::size_t choice = 0; choice < row.choices.size(); ++choice) {
      EditSettings settings;
      row.set(settings, static_cast<double>(choice));
      EXPECT_EQ(plain(name(settings.*member)), row.choices[choice]);
      EXPECT_EQ(row.get(settings), static_cast<double>(choice));
    }
  };
  check("laplacian", &EditSettings::laplacian);
  check("detail_rotation", &EditSettings::rotation);
  check("turning", &EditSettings::turning);
  check("rough", &EditSettings::rough);
  EditSettings settings;
  setting("membrane").set(settings, 1200);
  EXPECT_EQ(settings.membrane, 1200);
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
