// SPDX-License-Identifier: GPL-3.0-or-later
#include "report_steps.h"

#include <QJsonObject>
#include <type_traits>
#include <variant>

using namespace lapedit;

namespace {

QJsonValue jsonOf(const decltype(Figure::value)& value) {
  return std::visit(
      [](const auto& known) {
        using Type = std::decay_t<decltype(known)>;
        if constexpr (std::is_same_v<Type, std::monostate>) {
          return QJsonValue();
        } else if constexpr (std::is_same_v<Type, std::string>) {
          return QJsonValue(QString::fromStdString(known));
        } else {
          return QJsonValue(known);
        }
      },
      value);
}

QJsonObject object(const std::vector<Figure>& figures) {
  QJsonObject all;
  for (const Figure& figure : figures) {
    all[figure.name] = jsonOf(figure.value);
  }
  return all;
}

QJsonObject step(const EditReport& report) {
  QJsonObject all = object(report.figures());
  all["milliseconds"] = object(report.times());
  QJsonArray landmarks;
  for (const LandmarkResidual& one : report.landmarks) {
    landmarks.append(
        QJsonObject{{"name", QString::fromStdString(one.name)}, {"vertex", one.vertex}, {"residual", one.residual}});
  }
  all["landmarks"] = landmarks;
  return all;
}

}  // namespace

QJsonArray jsonOfSteps(const std::vector<EditReport>& reports) {
  QJsonArray steps;
  for (const EditReport& each : reports) {
    steps.append(step(each));
  }
  return steps;
}
