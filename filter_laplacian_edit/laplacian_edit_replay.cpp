// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "filters.h"
#include "lapedit/json/edit_script.h"
#include "lapedit/mesh/coordinate_space.h"

using namespace lapedit;
using namespace lapedit::host;

FilterAction laplacianEditReplay() {
  return {"Laplacian Edit Replay",
          "apply_coord_laplacian_editing_replay",
          "Repeats an edit that was recorded or written as JSON, exactly or a part of the way. " + aboutTheMethod(),
          {{Parameter::Kind::Text, "edit", QString(), "Edit",
            "The edit as JSON text, beginning with a brace, or the path of a .json file."},
           {Parameter::Kind::Real, "fraction", 1.0, "Fraction",
            "How far each handle goes: from 0 (no change) to 1 (the whole edit). Rotations go by angle."}},
          [](const ParameterValues& values, CMeshO& host, const Progress& progress) {
            const auto make = [&](const BridgedMesh& bridged) {
              Edit edit = load_edit(values.text("edit").toStdString(), &bridged.mesh);
              edit = in_space(std::move(edit), space_of_file(values.layer_file));
              return with_scans(std::move(edit), layer_reader(values.layers, host));
            };
            return write_edited(host, edit_mesh(host, make, values.real("fraction"), progress));
          }};
}
