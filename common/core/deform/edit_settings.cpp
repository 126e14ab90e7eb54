// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_settings.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

#include "lapedit/base/refuse.h"

namespace lapedit {
namespace {

/// Returns the table row of the setting that `member` stores.
template <auto member>
Setting row(Setting::Kind kind, const char* key, const char* subject, const char* range, double low, double high,
            const char* help, std::vector<const char*> choices = {}) {
  const auto get = [](const EditSettings& settings) { return static_cast<double>(settings.*member); };
  const auto set = [](EditSettings& settings, double value) {
    settings.*member = static_cast<std::decay_t<decltype(settings.*member)>>(value);
  };
  return {kind, key, subject, range, low, high, help, get, set, std::move(choices)};
}

template <auto member>
Setting choice(const char* key, const char* subject, const char* range, const char* help,
               std::vector<const char*> choices) {
  const auto last = static_cast<double>(choices.size() - 1);
  return row<member>(Setting::Kind::Choice, key, subject, range, 0, last, help, std::move(choices));
}

constexpr double kLightest = 1e-6, kHeaviest = 1e6;
constexpr const char* kWeights = "a number from 0.000001 to 1000000";

}  // namespace

const std::vector<Setting>& settings_table() {
  using Kind = Setting::Kind;
  using S = EditSettings;
  static const std::vector<Setting> table = [] {
    Setting method = choice<&S::method>(
        "method", "method", "default, paper or linear",
        "How details rotate with the surface: by rotations that are fitted and solved for alternately (default), by "
        "one "
        "pass of the paper's frames of smooth normals (paper), or not at all (linear). The method gives the other "
        "settings their defaults.",
        {"default", "paper", "linear"});
    method.set = [](S& settings, double value) { settings = S::of(static_cast<EditMethod>(static_cast<int>(value))); };
    Setting order = row<&S::order>(
        Kind::Whole, "order", "order of the Laplacian", "1, 2 or 3", 1, 3,
        "How often the Laplacian is applied, 1 to 3, with the method default 1 only. Higher orders blend "
        "more smoothly into the fixed vertices and take longer; use them for pulls with the method linear.");
    order.fixed = EditMethod::Default;
    Setting iterations = row<&S::iterations>(
        Kind::Whole, "iterations", "number of iterations", "a whole number from 0 to 100", 0, 100,
        "Number of passes, each of which fits the rotations to the last result, 0 to 100. 0: automatic (3, "
        "more in wires and springs).");
    iterations.only = EditMethod::Default;
    Setting radius =
        row<&S::normal_radius>(Kind::Length, "normal_radius", "normal radius",
                               "a finite length, or 0 for an automatic one", 0, std::numeric_limits<double>::max(),
                               "Radius of the smoothing of normals; has to exceed the size of the details. 0: chosen "
                               "from the mesh.");
    radius.only = EditMethod::Paper;
    Setting rough = choice<&S::rough>(
        "rough", "rough deformation", "unrotated or falloff",
        "What the rotations are estimated from: the solution with unrotated details (unrotated, the paper's way), or "
        "the handle's motion, falling off with the distance along the surface (falloff), which needs no solution.",
        {"unrotated", "falloff"});
    rough.only = EditMethod::Paper;
    Setting contact = row<&S::contact>(Kind::Switch, "contact", "stop at contact", "true or false", 0, 1,
                                       "Whether a result stops where the surface would cross itself or the surface "
                                       "around it. Frames of a drag do not.");
    contact.only = EditMethod::Default;
    return std::vector<Setting>{
        method,
        choice<&S::laplacian>("laplacian", "Laplacian", "umbrella, cotangent, mean_value or surface",
                              "How the detail at a vertex is measured: against the plain mean of its neighbours "
                              "(umbrella, the paper's choice), with cotangent weights, which depend less on the "
                              "triangulation, with mean-value weights, which uneven and obtuse triangles suit as "
                              "well, or with weights and areas of the surface, which do not depend on how it is "
                              "triangulated.",
                              {"umbrella", "cotangent", "mean_value", "surface"}),
        order,
        row<&S::membrane>(
            Kind::Number, "membrane", "membrane weight", "a number from 0 to 1000000", 0, 1e6,
            "Cost of stretching against bending, 0 to 1000000: with 0 the surface only keeps from bending "
            "(the paper's way); the more, the more evenly lengths are kept over the whole region."),
        row<&S::handle_weight>(Kind::Number, "handle_weight", "handle weight", kWeights, kLightest, kHeaviest,
                               "How strongly the handle is drawn to its target, 0.000001 to 1000000."),
        row<&S::anchor_weight>(Kind::Number, "anchor_weight", "anchor weight", kWeights, kLightest, kHeaviest,
                               "How strongly the band inside the boundary is held in place, 0.000001 to 1000000."),
        row<&S::detail>(Kind::Number, "detail", "detail", "a number from 0 to 2", 0, 2,
                        "How much of the details in the region remains, 0 to 2: 0 removes dents and bumps, 1 keeps "
                        "them, 2 doubles them."),
        iterations,
        radius,
        rough,
        contact};
  }();
  return table;
}

const char* name(EditMethod method) {
  return settings_table().front().choices[static_cast<std::size_t>(method)];
}

const char* name(RoughDeformation rough) {
  return rough == RoughDeformation::Unrotated ? "unrotated" : "falloff";
}

std::string title_of(const char* key) {
  std::string title = key;
  std::replace(title.begin(), title.end(), '_', ' ');
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return title;
}

EditSettings EditSettings::of(EditMethod method) {
  EditSettings settings;
  settings.method = method;
  if (method != EditMethod::Default) {
    settings.laplacian = LaplacianKind::Umbrella;
    settings.membrane = 0;
    settings.handle_weight = settings.anchor_weight = 10;
  }
  return settings;
}

bool operator==(const EditSettings& a, const EditSettings& b) {
  return std::all_of(settings_table().begin(), settings_table().end(),
                     [&](const Setting& setting) { return setting.get(a) == setting.get(b); });
}

void validate(const EditSettings& settings) {
  for (const Setting& setting : settings_table()) {
    const double value = setting.get(settings);
    if (!(value >= setting.low && value <= setting.high)) {
      refuse_edit(ErrorCause::BadParameter, {setting.key}, "The ", setting.subject, " is ", value, ": give ",
                  setting.range, ".");
    }
    if (!setting.applies(settings.method) && value != setting.get(EditSettings())) {
      refuse_edit(ErrorCause::BadParameter, {setting.key}, "The ", setting.subject, " has no meaning with the method ",
                  name(settings.method), ": leave it out, or use the method ", name(*setting.only), ".");
    }
    const double usual = setting.get(EditSettings::of(settings.method));
    if (setting.fixed == settings.method && value != usual) {
      refuse_edit(ErrorCause::BadParameter, {setting.key}, "The ", setting.subject, " is ", value, ", but the method ",
                  name(settings.method), " has ", usual, " only: leave it out, or use another method.");
    }
  }
}

}  // namespace lapedit
