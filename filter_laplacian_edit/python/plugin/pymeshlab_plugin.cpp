// SPDX-License-Identifier: GPL-3.0-or-later
#include "pymeshlab_plugin.h"

#include <optional>
#include <utility>

#include "lapedit/json/edit_script.h"
#include "lapedit/json/report_json.h"
#include "lapedit/mesh/coordinate_space.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

/// An edit that was made, and of what.
struct Kept {
  QString text;
  double fraction;
  EditedMesh edited;
};

/// PyMeshLab may damage a MeshSet when a filter refuses, so an edit is first made of a copy, and then again of the
/// user's mesh: that finds the result here.
thread_local std::optional<Kept> kept;
thread_local std::string report;

bool same(const TriangleMesh& a, const TriangleMesh& b) {
  return a.vertices.rows() == b.vertices.rows() && a.faces.rows() == b.faces.rows() && a.vertices == b.vertices &&
         a.faces == b.faces;
}

FilterOutcome replay(const ParameterValues& values, CMeshO& host, const Progress& progress) {
  const QString text = values.text("edit");
  const double fraction = values.real("fraction");
  BridgedMesh bridged = read_mesh(host);
  if (kept && kept->text == text && kept->fraction == fraction && same(kept->edited.bridged.mesh, bridged.mesh)) {
    kept->edited.bridged = std::move(bridged);
  } else {
    kept.reset();
    const Edit edit = in_space(load_edit(text.toStdString()), space_of_file(values.layer_file));
    const auto make = [&edit](const BridgedMesh&) { return edit; };
    kept = Kept{text, fraction, edit_mesh(host, make, fraction, progress)};
  }
  const TriangleMesh& mesh = kept->edited.bridged.mesh;
  const Json all = {{"mesh", {{"vertices", mesh.vertices.rows()}, {"faces", mesh.faces.rows()}}},
                    {"fraction", fraction},
                    {"steps", report_json(kept->edited.pose.reports)}};
  report = all.dump(-1, ' ', false, Json::error_handler_t::replace);
  return write_edited(host, kept->edited);
}

FilterAction keepingReplay() {
  FilterAction filter = laplacianEditReplay();
  filter.run = replay;
  return filter;
}

}  // namespace

PyMeshLabPlugin::PyMeshLabPlugin() : VertexFilterPlugin("PyMeshLabLaplacianEdit", {laplacianEdit(), keepingReplay()}) {}

const char* laplacian_edit_report() {
  return report.c_str();
}

void laplacian_edit_forget() {
  kept.reset();
  report.clear();
}
