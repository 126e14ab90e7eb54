// SPDX-License-Identifier: GPL-3.0-or-later
#include "report.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

#include "host/batch_host.h"
#include "lapedit_host/mesh_bridge.h"
#include "report_steps.h"

using namespace lapedit;

QByteArray reportText(const Options& options, const JobReport& report) {
  QJsonArray outputs;
  const QStringList files = options.outputs();
  for (int k = 0; k < files.size(); ++k) {
    const Pose& pose = report.poses.at(static_cast<std::size_t>(k));
    QJsonObject output = {{"file", files[k]},
                          {"steps", jsonOfSteps(pose.steps)},
                          {"coordinate_error", pose.lost ? QJsonValue(*pose.lost) : QJsonValue()}};
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
      {"not_kept", QJsonArray::fromStringList(report.notKept)},
      {"milliseconds", QJsonObject{{"read", report.readMs}, {"edit", report.editMs}, {"write", report.writeMs}}}};
  if (!options.targets.isEmpty()) {
    all["targets"] = options.targets;
  }
  return QJsonDocument(all).toJson();
}
