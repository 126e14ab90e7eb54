// SPDX-License-Identifier: GPL-3.0-or-later
#include "report.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <type_traits>
#include <variant>

#include "host/batch_host.h"
#include "lapedit_host/mesh_bridge.h"

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

QByteArray reportText(const Options& options, const JobReport& report) {
  QJsonArray outputs;
  const QStringList files = options.outputs();
  for (int k = 0; k < files.size(); ++k) {
    const Pose& pose = report.poses.at(static_cast<std::size_t>(k));
    QJsonArray steps;
    for (const EditReport& each : pose.steps) {
      steps.append(step(each));
    }
    QJsonObject output = {
        {"file", files[k]}, {"steps", steps}, {"coordinate_error", pose.lost ? QJsonValue(*pose.lost) : QJsonValue()}};
    if (!options.isScript) {
      output["fraction"] = pose.fraction;
    }
    outputs.append(output);
  }
  const bool single = host::kStoredScalar == StoredScalar::Float;
  QJsonObject all = {
      {"laplacian_edit_report", 1},
      {"program", "laplacian-edit " LAPEDIT_VERSION},
      {"host", host::BatchHost::version()},
      {"scalar", single ? "float" : "double"},
      {"input", options.input},
      {"edit", options.edit},
      {"mesh", QJsonObject{{"vertices", report.vertices}, {"faces", report.faces}}},
      {"outputs", outputs},
      {"milliseconds", QJsonObject{{"read", report.readMs}, {"edit", report.editMs}, {"write", report.writeMs}}}};
  if (!options.targets.isEmpty()) {
    all["targets"] = options.targets;
  }
  return QJsonDocument(all).toJson();
}
