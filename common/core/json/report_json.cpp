// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/report_json.h"

#include <string>
#include <type_traits>
#include <variant>

namespace lapedit {
namespace {

Json json_of(const Figure::Value& value) {
  return std::visit(
      [](const auto& known) {
        if constexpr (std::is_same_v<std::decay_t<decltype(known)>, std::monostate>) {
          return Json();
        } else {
          return Json(known);
        }
      },
      value);
}

}  // namespace

Json report_json(const std::vector<EditReport>& steps) {
  Json all = Json::array();
  for (const EditReport& report : steps) {
    Json step;
    for (const Figure& figure : report_table()) {
      const std::string key = figure.key == nullptr ? "" : figure.key;
      if (!key.empty() && (report.fit || key.rfind("fit/", 0) != 0)) {
        step[Json::json_pointer("/" + key)] = json_of(figure.get(report));
      }
    }
    step["fit"];  // null for a step without a fit
    step["landmarks"] = Json::array();
    for (const LandmarkResidual& one : report.landmarks) {
      step["landmarks"].push_back({{"name", one.name}, {"vertex", one.vertex}, {"residual", one.residual}});
    }
    all.push_back(std::move(step));
  }
  return all;
}

}  // namespace lapedit
