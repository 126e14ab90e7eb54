// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/json/report_json.h"

#include <type_traits>
#include <variant>

namespace lapedit {
namespace {

Json object(const std::vector<Figure>& figures) {
  Json all = Json::object();
  for (const Figure& figure : figures) {
    std::visit(
        [&](const auto& known) {
          if constexpr (std::is_same_v<std::decay_t<decltype(known)>, std::monostate>) {
            all[figure.name] = nullptr;
          } else {
            all[figure.name] = known;
          }
        },
        figure.value);
  }
  return all;
}

}  // namespace

Json report_json(const std::vector<EditReport>& steps) {
  Json all = Json::array();
  for (const EditReport& report : steps) {
    Json step = object(report.figures());
    step["milliseconds"] = object(report.times());
    step["landmarks"] = Json::array();
    for (const LandmarkResidual& one : report.landmarks) {
      step["landmarks"].push_back({{"name", one.name}, {"vertex", one.vertex}, {"residual", one.residual}});
    }
    all.push_back(std::move(step));
  }
  return all;
}

}  // namespace lapedit
