// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit_host/mesh_edit.h"

#include <fstream>
#include <type_traits>
#include <utility>
#include <variant>

#include "lapedit/edit/positions.h"
#include "lapedit/mesh/coordinate_space.h"
#include "lapedit_host/pose_writer.h"
#include "lapedit_vcg/self_intersections.h"

namespace lapedit::host {
namespace {

constexpr int kFewVertices = 20000;

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

std::string space_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(1 << 16, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  return space_in_header(begin);
}

EditedMesh edit_mesh(const CMeshO& host, const MakeEdit& make, double fraction, const Progress& progress) {
  EditedMesh edited;
  edited.bridged = read_mesh(host);
  const TriangleMesh& mesh = edited.bridged.mesh;
  validate(mesh);
  const Edit edit = make(edited.bridged);
  edited.adjacency = build_adjacency(static_cast<int>(mesh.vertices.rows()), mesh.faces);
  const SelectedVertices selection = {selected_vertices(host, edited.bridged),
                                      vertices_of_selected_faces(host, edited.bridged)};
  edited.pose =
      std::move(apply_edit(mesh, edited.adjacency, edit, selection, {fraction}, kStoredScalar, progress).front());
  count_self_intersections(mesh, edited.pose, kFewVertices);
  return edited;
}

FilterOutcome write_edited(CMeshO& host, const EditedMesh& edited) {
  FilterOutcome outcome = {text_of(edited.pose.reports), figures_of(edited.pose.reports)};
  write_positions(host, edited.bridged, edited.adjacency, edited.pose);
  return outcome;
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
