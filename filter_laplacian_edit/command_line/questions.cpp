// SPDX-License-Identifier: GPL-3.0-or-later
#include "questions.h"

#include <QFileInfo>

#include "failure.h"
#include "lapedit/base/format_text.h"
#include "lapedit/mesh/mesh_summary.h"
#include "lapedit/mesh/vertex_finder.h"
#include "lapedit_host/mesh_bridge.h"

using namespace lapedit;
using namespace lapedit::host;

namespace {

/// Formats a point as --nearest and JSON keys read it, with all digits of a float.
std::string coordinates(const Vector3& point) {
  return format_text("%.9g,%.9g,%.9g", point[0], point[1], point[2]);
}

std::string infoText(const BridgedMesh& bridged, const CMeshO& host) {
  const MeshSummary summary = summary_of(bridged.mesh);
  std::string text = format_text("vertices: %d (%d without a face, %d not finite)\nfaces: %d\n", summary.vertices,
                                 summary.loose, summary.not_finite, summary.faces);
  if (!summary.box.isEmpty()) {
    text += "box: " + coordinates(summary.box.min()) + " to " + coordinates(summary.box.max()) +
            format_text(", diagonal %.9g\n", summary.box.diagonal().norm());
  }
  text += format_text("pieces: %d, the largest of %d vertices\nborders: %d of %d edges in all\n", summary.pieces,
                      summary.largest_piece, summary.borders, summary.border_edges);
  return text + format_text("selected: %d vertices, %d faces\n",
                            static_cast<int>(selected_vertices(host, bridged).size()), host.sfn);
}

}  // namespace

std::string answer(const Options& options, Notes& notes) {
  notes.timeLimit(options.timeout);
  notes.doing("reading " + quotedPath(options.input), Unreadable, QFileInfo(options.input).size());
  BatchHost batch(options.plugins, [&notes](double fraction, const char*) {
    notes.progress(fraction);
    return true;
  });
  try {
    batch.open(options.input, options.input);
  } catch (const BatchError& error) {
    throw Failure(Unreadable, error.what());
  }
  notes.doing("looking at the mesh", Unexpected);
  const CMeshO& host = *batch.mesh();
  const BridgedMesh bridged = read_mesh(host);
  std::string text = options.info ? infoText(bridged, host) : std::string();
  if (!options.nearest.empty()) {
    const VertexFinder finder(bridged.mesh);
    for (const Vector3& point : options.nearest) {
      const VertexFinder::Found found = finder.anywhere(point, "The point");
      text += format_text("vertex: %d, place: ", found.vertex) +
              coordinates(bridged.mesh.vertices.row(found.vertex).transpose()) +
              format_text(", distance: %.6g\n", found.distance);
    }
  }
  return text;
}
