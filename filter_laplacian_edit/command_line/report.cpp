// SPDX-License-Identifier: GPL-3.0-or-later
#include "report.h"

#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>

#include "batch_host.h"
#include "lapedit_host/mesh_bridge.h"

using namespace lapedit;

namespace {

QJsonObject step(const EditReport& report) {
  return {{"mesh_vertices", report.mesh_vertices},
          {"handle", report.handle},
          {"free", report.free},
          {"anchors", report.anchors},
          {"fixed", report.fixed},
          {"left_out", report.left_out},
          {"laplacian", QString::fromStdString(report.laplacian)},
          {"order", report.order},
          {"detail_rotation", QString::fromStdString(report.rotation)},
          {"turning", QString::fromStdString(report.turning)},
          {"rough", QString::fromStdString(report.rough)},
          {"membrane", report.membrane},
          {"iterations", report.iterations},
          {"passes_dropped", report.passes_dropped},
          {"normal_radius", report.normal_radius},
          {"uniform_edges", report.uniform_edges},
          {"solver", QString::fromStdString(report.backend)},
          {"refinements", report.refinements},
          {"factor_taken_over", report.factor_taken_over},
          {"normal_equation_residual", report.normal_equation_residual},
          {"handle_displacement", report.handle_displacement},
          {"handle_residual", report.handle_residual},
          {"anchor_residual", report.anchor_residual},
          {"rotation_mean", report.rotation_mean},
          {"rotation_max", report.rotation_max},
          {"stretch_rms", report.stretch_rms},
          {"stretch_max", report.stretch_max},
          {"flipped", report.flipped},
          {"folded", report.folded},
          {"volume", report.volume},
          {"volume_change", report.volume_change},
          {"detail_height", report.detail_height ? QJsonValue(*report.detail_height) : QJsonValue()},
          {"rotation_left", report.rotation_left},
          {"new_intersections", report.new_intersections ? QJsonValue(*report.new_intersections) : QJsonValue()},
          {"advice", QString::fromStdString(report.advice())},
          {"milliseconds", QJsonObject{{"region", report.region_ms},
                                       {"operator", report.operator_ms},
                                       {"factorisation", report.factor_ms},
                                       {"smoothing", report.kernel_ms},
                                       {"rough", report.unrotated_ms},
                                       {"normals", report.normals_ms},
                                       {"rotations", report.rotate_ms},
                                       {"solve", report.solve_ms}}}};
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
    QJsonObject output = {{"file", files[k]}, {"steps", steps}};
    if (!options.isScript) {
      output["fraction"] = pose.fraction;
    }
    outputs.append(output);
  }
  const bool single = host::kStoredScalar == StoredScalar::Float;
  const QJsonObject all = {
      {"laplacian_edit_report", 1},
      {"program", "laplacian-edit " LAPEDIT_VERSION},
      {"host", host::BatchHost::version()},
      {"scalar", single ? "float" : "double"},
      {"input", options.input},
      {"edit", options.edit},
      {"mesh", QJsonObject{{"vertices", report.vertices}, {"faces", report.faces}}},
      {"outputs", outputs},
      {"milliseconds", QJsonObject{{"read", report.read_ms}, {"edit", report.edit_ms}, {"write", report.write_ms}}}};
  return QJsonDocument(all).toJson();
}
