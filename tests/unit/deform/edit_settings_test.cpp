// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_settings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "lapedit/base/error.h"
#include "lapedit/base/format_text.h"

namespace lapedit::edit_settings_test {
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
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kNaN = std::numeric_limits<double>::quiet_NaN();
  for (const Setting& setting : settings_table()) {
    if (setting.kind == Setting::Kind::Switch || std::string(setting.key) == "method") {
      continue;  // any number is on or off; setting the method sets all others
    }
    const auto with = [&](double value) {
      EditSettings settings = EditSettings::of(setting.only.value_or(EditMethod::Linear));
      setting.set(settings, value);
      EXPECT_TRUE(std::isnan(value) || setting.get(settings) == value) << setting.key;
      return refusal(settings);
    };
    const bool length = setting.kind == Setting::Kind::Length, real = length || setting.kind == Setting::Kind::Number;
    const double below = setting.low - (real ? 1e-7 : 1);
    EXPECT_EQ(with(setting.low), "");
    EXPECT_EQ(with(setting.high), "");
    EXPECT_EQ(with(below),
              std::string("The ") + setting.subject + " is " + number_text(below) + ": give " + setting.range + ".");
    EXPECT_NE(with(length ? kInfinity : setting.high + 1), "");
    EXPECT_TRUE(!real || !with(kNaN).empty()) << setting.key;
  }
}

TEST(EditSettings, MethodGivesTheOthersTheirValues) {
  const EditSettings standard, paper = EditSettings::of(EditMethod::Paper),
                               linear = EditSettings::of(EditMethod::Linear);
  EXPECT_EQ(standard, EditSettings::of(EditMethod::Default));
  EXPECT_EQ(standard.laplacian, LaplacianKind::Surface);
  EXPECT_EQ(standard.membrane, 500);
  EXPECT_EQ(standard.handle_weight, 30);
  for (const EditSettings& settings : {paper, linear}) {
    EXPECT_EQ(settings.laplacian, LaplacianKind::Umbrella);
    EXPECT_EQ(settings.order, 1);
    EXPECT_EQ(settings.membrane, 0);
    EXPECT_EQ(settings.handle_weight, 10);
    EXPECT_EQ(settings.anchor_weight, 10);
    EXPECT_EQ(refusal(settings), "");
  }
  EditSettings changed = standard;
  changed.iterations = 7;
  settings_table().front().set(changed, static_cast<double>(EditMethod::Paper));
  EXPECT_EQ(changed, paper);
}

TEST(EditSettings, WhatTheMethodLacksIsRefused) {
  EditSettings settings = EditSettings::of(EditMethod::Paper);
  settings.iterations = 2;
  EXPECT_EQ(refusal(settings),
            "The number of iterations has no meaning with the method paper: leave it out, or use the method default.");
  settings = EditSettings();
  settings.normal_radius = 0.1;
  EXPECT_NE(refusal(settings).find("use the method paper."), std::string::npos);
  settings = EditSettings::of(EditMethod::Linear);
  settings.rough = RoughDeformation::Falloff;
  EXPECT_NE(refusal(settings).find("use the method paper."), std::string::npos);
  settings = EditSettings();
  settings.order = 2;
  EXPECT_EQ(refusal(settings),
            "The order of the Laplacian is 2, but the method default has 1 only: leave it out, or use another method.");
}

}  // namespace
}  // namespace lapedit::edit_settings_test
