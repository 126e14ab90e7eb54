// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/deform/edit_report.h"

#include "lapedit/base/format_text.h"
#include "lapedit/deform/edit_settings.h"

namespace lapedit {
std::string EditReport::text() const {
  std::string lines = format_text("Region: %d handle, %d free, %d anchor vertices; %d fixed of %d", handle, free,
                                  anchors, fixed, mesh_vertices);
  if (left_out > 0) {
    lines += format_text("; %d in parts of the region without a handle stay", left_out);
  }
  lines += format_text("\nOperator: %s of order %d", laplacian.c_str(), order);
  if (uniform_edges > 0) {
    lines += format_text(", %d edges at degenerate triangles took the uniform weight", uniform_edges);
  }
  lines += format_text("; detail rotation: %s", rotation.c_str());
  if (iterations > 0) {
    if (turning != name(DetailTurning())) {
      lines += ", turned by " + turning;
    }
    if (rough != name(RoughDeformation())) {
      lines += ", first from the " + rough;
    }
    lines += format_text(", %d %s, normal radius %.6g", iterations, iterations == 1 ? "pass" : "passes", normal_radius);
  }
  lines += format_text("; solver: %s", backend.c_str());
  if (refinements > 0) {
    lines += format_text(", %d refinement steps", refinements);
  }
  lines += format_text("\nHandle: to move %.6g, off its target by %.3g (%.3g %%); anchors moved at most %.3g",
                       handle_displacement, handle_residual,
                       handle_displacement > 0 ? 100 * handle_residual / handle_displacement : 0.0, anchor_residual);
  lines += format_text(
      "\nDetail rotation: mean %.3g, largest %.3g degrees; edge stretch: RMS %.3g %%, largest %.3g %%; triangles "
      "flipped: %d",
      rotation_mean, rotation_max, 100 * stretch_rms, 100 * stretch_max, flipped);
  lines += format_text("; normal-equation residual %.2g", normal_equation_residual);
  if (passes_dropped > 0) {
    lines += format_text("\nDropped: %d of %d rotation passes, since they made it worse.", passes_dropped,
                         passes_dropped + iterations);
    lines += order > 1 ? " Order 1 turns details better." : "";
  }
  lines += format_text(
      "\nMilliseconds: region %.1f, operator %.1f, factor %.1f, smoothing table %.1f, rough solve %.2f, normals %.2f, "
      "rotate %.2f, solve %.2f",
      region_ms, operator_ms, factor_ms, kernel_ms, unrotated_ms, normals_ms, rotate_ms, solve_ms);
  return lines;
}

}  // namespace lapedit
