// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/mesh_edit.h"

#include <type_traits>
#include <utility>
#include <variant>

#include "lapedit/edit/places.h"
#include "lapedit_host/pose_writer.h"
#include "lapedit_host/self_intersections.h"

namespace lapedit::host {
namespace {

void add(const std::string& prefix, const std::vector<Figure>& figures, std::map<std::string, QVariant>& all) {
  for (const Figure& figure : figures) {
    const auto put = [&](const auto& known) {
      if constexpr (std::is_arithmetic_v<std::decay_t<decltype(known)>>) {
        all[prefix + figure.name] = known;
      }
    };
    std::visit(put, figure.value);
  }
}

}  // namespace

EditedMesh edit_mesh(const CMeshO& host, const MakeEdit& make, const std::vector<double>& fractions, int most_vertices,
                     const Progress& progress) {
  EditedMesh edited;
  edited.bridged = read_mesh(host);
  const TriangleMesh& mesh = edited.bridged.mesh;
  validate(mesh);
  const Edit edit = make(edited.bridged);
  require_same_mesh(mesh, edit);
  edited.adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  const SelectedVertices selection = {selected_vertices(host, edited.bridged),
                                      vertices_of_selected_faces(host, edited.bridged)};
  edited.poses = apply_edit(mesh, edited.adjacency, located(mesh, edited.adjacency, edit, selection), fractions,
                            kStoredScalar, progress);
  for (EditResult& pose : edited.poses) {
    count_self_intersections(mesh, pose, most_vertices);
  }
  return edited;
}

FilterOutcome write_edited(CMeshO& host, const EditedMesh& edited, const ReportSink& sink) {
  const EditResult& pose = edited.poses.front();
  FilterOutcome outcome = {text_of(pose.reports), figures_of(pose.reports)};
  write_positions(host, edited.bridged, edited.adjacency, pose);
  if (sink) {
    sink(pose.reports);
  }
  return outcome;
}

std::string text_of(const std::vector<EditReport>& reports) {
  std::string text;
  for (std::size_t k = 0; k < reports.size(); ++k) {
    if (reports.size() > 1) {
      text += (k > 0 ? "\nStep " : "Step ") + std::to_string(k + 1) + " of " + std::to_string(reports.size()) + "\n";
    }
    text += reports[k].text();
  }
  return text;
}

std::map<std::string, QVariant> figures_of(const std::vector<EditReport>& reports) {
  std::map<std::string, QVariant> all;
  const auto add_step = [&all](const std::string& prefix, const EditReport& report) {
    add(prefix, report.figures(), all);
    add(prefix + "milliseconds_", report.times(), all);
  };
  for (std::size_t k = 0; k < reports.size() && reports.size() > 1; ++k) {
    add_step("step_" + std::to_string(k + 1) + "_", reports[k]);
  }
  add_step("", reports.back());
  all["steps"] = static_cast<int>(reports.size());
  return all;
}

}  // namespace lapedit::host
