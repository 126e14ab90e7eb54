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

Json distances_json(const FitDistances& distances) {
  return {{"matched", distances.matched},
          {"rms", distances.rms},
          {"median", distances.median},
          {"most", distances.most},
          {"largest", distances.largest}};
}

Json fit_json(const FitReport& fit) {
  return {{"to", fit.scan},
          {"mode", fit.mode},
          {"align", fit.aligned},
          {"scale", fit.scale},
          {"alignment", fit.alignment},
          {"other_alignment", fit.second ? Json(*fit.second) : Json()},
          {"by_landmarks", fit.by_landmarks.has_value()},
          {"reversed_normals", fit.reversed_normals},
          {"size_ratio", fit.size_ratio},
          {"stages", fit.stages},
          {"rounds", fit.rounds},
          {"to_scan", distances_json(fit.to_scan)},
          {"from_scan", distances_json(fit.from_scan)},
          {"milliseconds",
           {{"align", fit.align_ms}, {"factor", fit.factor_ms}, {"pairs", fit.pairs_ms}, {"solve", fit.solve_ms}}}};
}

}  // namespace

Json report_json(const std::vector<EditReport>& steps) {
  Json all = Json::array();
  for (const EditReport& report : steps) {
    Json step = object(report.figures());
    step["milliseconds"] = object(report.times());
    step["fit"] = report.fit ? fit_json(*report.fit) : Json();
    step["landmarks"] = Json::array();
    for (const LandmarkResidual& one : report.landmarks) {
      step["landmarks"].push_back({{"name", one.name}, {"vertex", one.vertex}, {"residual", one.residual}});
    }
    all.push_back(std::move(step));
  }
  return all;
}

}  // namespace lapedit
