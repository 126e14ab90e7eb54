// SPDX-License-Identifier: GPL-3.0-or-later
#include <type_traits>
#include <utility>
#include <variant>

#include "filters.h"
#include "lapedit/json/edit_script.h"
#include "lapedit_host/mesh_bridge.h"
#include "lapedit_host/self_intersections.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

FilterOutcome run(const ParameterValues& values, CMeshO& host, const Progress& progress, const ReportSink& sink,
                  int mostVertices) {
  const Edit edit = load_edit(values.text("edit").toStdString());
  const BridgedMesh bridged = read_mesh(host);
  EditResult result = apply_edit(bridged.mesh, edit, values.real("fraction"), kStoredScalar, progress);
  write_positions(host, bridged, result);
  count_self_intersections(bridged.mesh, result, mostVertices);
  if (sink) {
    sink(result.reports);
  }
  return {textOf(result.reports), figuresOf(result.reports)};
}

/// Texts and what is not known are left out.
void add(const std::string& before, const std::vector<Figure>& figures, std::map<std::string, QVariant>& all) {
  for (const Figure& figure : figures) {
    const auto put = [&](const auto& known) {
      if constexpr (std::is_arithmetic_v<std::decay_t<decltype(known)>>) {
        all[before + figure.name] = known;
      }
    };
    std::visit(put, figure.value);
  }
}

}  // namespace

std::map<std::string, QVariant> figuresOf(const std::vector<EditReport>& reports) {
  std::map<std::string, QVariant> all;
  for (std::size_t k = 0; k < reports.size(); ++k) {
    std::vector<std::string> names;
    if (k + 1 == reports.size()) {
      names.emplace_back();
    }
    if (reports.size() > 1) {
      names.push_back("step_" + std::to_string(k + 1) + "_");
    }
    for (const std::string& name : names) {
      add(name, reports[k].figures(), all);
      add(name + "milliseconds_", reports[k].times(), all);
    }
  }
  all["steps"] = static_cast<int>(reports.size());
  return all;
}

std::string textOf(const std::vector<EditReport>& reports) {
  std::string text;
  for (std::size_t k = 0; k < reports.size(); ++k) {
    text += (k > 0 ? "\nStep " : "Step ") + std::to_string(k + 1) + " of " + std::to_string(reports.size()) + "\n" +
            reports[k].text();
  }
  return text;
}

FilterAction laplacianEditReplay(ReportSink sink, int mostVertices) {
  return {
      "Laplacian Edit Replay",
      "apply_coord_laplacian_editing_replay",
      "Repeats an edit that was recorded or written as JSON, exactly or a part of the way. " + aboutTheMethod(),
      {{Parameter::Kind::Text, "edit", QString(), "Edit",
        "The edit as JSON text, beginning with a brace, or the path of a .json file."},
       {Parameter::Kind::Real, "fraction", 1.0, "Fraction",
        "How far each handle goes: from 0 (no change) to 1 (the whole edit). Rotations go by angle."}},
      [sink = std::move(sink), mostVertices](const ParameterValues& values, CMeshO& host, const Progress& progress) {
        return run(values, host, progress, sink, mostVertices);
      }};
}
