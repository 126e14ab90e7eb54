// SPDX-License-Identifier: GPL-3.0-or-later
#include "lapedit/session/messages.h"

#include "lapedit/base/format_text.h"

namespace lapedit::messages {

// What the next click does -------------------------------------------------------------------------------------------

std::string drag_handles(std::size_t moving, std::size_t all) {
  return format_text(
      "Drag a handle: %zu of %zu move together, the others hold; Shift+click on a handle adds or removes it.", moving,
      all);
}

std::string large_region(double part) {
  return format_text("The region has %.0f %% of its piece: turn the wheel for a smaller one. ", 100 * part);
}

std::string dragging(const DragMotion& motion, bool by_button, bool full_frames) {
  const char* const pattern =
      by_button ? "%s: release to apply, Esc cancels; X Y Z N lock an axis, Ctrl moves in steps, digits set the amount."
                : "%s: click or press Return to apply, Esc cancels; X Y Z N lock an axis, Ctrl moves in steps, digits "
                  "set the amount.";
  const std::string text = format_text(pattern, motion.text().c_str());
  return full_frames ? text + " With these rotations each frame is a full solution." : text;
}

// Refusals -----------------------------------------------------------------------------------------------------------

std::string asymmetric(double fraction) {
  return format_text(
      "The mesh is not its own mirror image: its sides differ by %.1f %% of its size or more on average. The other "
      "side moves only where it has a vertex near the mirrored handle.",
      100 * fraction);
}

std::string out_of_range(const char* what, double value, const char* wanted) {
  return format_text("The %s is %g: give %s.", what, value, wanted);
}

std::string no_such_vertices(int vertices_of_mesh) {
  return format_text("The mesh has %d vertices, numbered from 0: choose a region among them.", vertices_of_mesh);
}

std::string outside_region(int vertex) {
  return format_text(
      "Vertex %d is outside the region: click inside it, brush it larger with Ctrl, or press W for a new region.",
      vertex);
}

std::string no_path(int from, int to) {
  return format_text("No path along edges leads from vertex %d to vertex %d: click on the same piece of the surface.",
                     from, to);
}

std::string curve_outside_region(const std::vector<int>& outside) {
  return format_text(
      "%zu vertices of the curve are outside the region, for example vertex %d: enlarge the region or click inside it.",
      outside.size(), outside.front());
}

std::string not_added(int vertex) {
  return format_text("Vertex %d is outside the region or in another handle: it was not added.", vertex);
}

std::string nothing_painted(int vertex) {
  return format_text(
      "Vertex %d and those around it are outside the region or in another handle: brush inside the region.", vertex);
}

std::string unconnected(const std::vector<int>& vertices) {
  return format_text(
      "%zu painted vertices, for example vertex %d, are not connected to a handle and will not move: paint the gap to "
      "them, or press G and click there.",
      vertices.size(), vertices.front());
}

std::string nothing_holds(int vertices) {
  return format_text(
      "Nothing holds this piece of %d vertices, so all of it would move: choose a smaller radius, press G and click "
      "where it should hold, or give a gap to connect it to its neighbours.",
      vertices);
}

std::string steps_lost(std::size_t steps) {
  return format_text(
      "The mesh was changed by another tool or filter: %zu %s cannot be undone any more. Save... writes %s until the "
      "next "
      "step.",
      steps, steps == 1 ? "step" : "steps", steps == 1 ? "it" : "them");
}

std::string in_no_handle(int vertex) {
  return format_text(
      "Vertex %d is in no handle: Shift-click on a handle vertex takes it away, Shift-drag brushes the region smaller.",
      vertex);
}

std::string single_vertex(MotionKind kind, int vertex) {
  const char* const pattern = kind == MotionKind::Rotate
                                  ? "Turning needs a handle of several vertices, and this one is vertex %d alone: set "
                                    "a handle size or add vertices with Ctrl-clicks."
                                  : "Scaling needs a handle of several vertices, and this one is vertex %d alone: set "
                                    "a handle size or add vertices with Ctrl-clicks.";
  return format_text(pattern, vertex);
}

// Lines for a log ----------------------------------------------------------------------------------------------------

/// Returns the name of a loaded step: that of the same motion by the mouse.
std::string saved_step(const EditStep& step, const std::vector<int>& moved) {
  if (step.fit) {
    return "Fit to a scan";
  }
  if (step.handles.empty()) {
    return "Detail";
  }
  const HandleGroup* const handle = moved.empty() ? nullptr : &step.handles[static_cast<std::size_t>(moved.back())];
  if (handle == nullptr || handle->transform.matrix) {
    return "Step of a saved edit";
  }
  return handle->targets.empty() ? motion_text(handle->transform) : "Bending a curve";
}

std::string not_possible(const std::string& why) {
  return format_text("not possible: %s", why.c_str());
}

std::string step_applied(std::size_t number, const DragMotion& motion, const std::vector<int>& handle, int region_size,
                         double prepare_ms, double solve_ms) {
  const char* const pattern =
      handle.size() == 1
          ? "step %zu: %s, handle of %zu vertex (%d), region of %d vertices, prepared in %.1f ms, solved in %.1f ms"
          : "step %zu: %s, handle of %zu vertices (the lowest is %d), region of %d vertices, prepared in %.1f ms, "
            "solved in %.1f ms";
  return format_text(pattern, number, motion.text().c_str(), handle.size(), handle.front(), region_size, prepare_ms,
                     solve_ms);
}

std::string step_adjusted(std::size_t number, bool is_new, int region_size, double prepare_ms, double solve_ms) {
  return format_text("step %zu%s: region of %d vertices, prepared in %.1f ms, solved in %.1f ms", number,
                     is_new ? ": another detail" : " again with other settings", region_size, prepare_ms, solve_ms);
}

std::string edit_applied(std::size_t steps) {
  return format_text(steps == 1 ? "%zu step of a saved edit applied" : "%zu steps of a saved edit applied", steps);
}

std::string loaded_step_advice(std::size_t number, const std::string& advice) {
  return format_text("step %zu of the saved edit: ", number) + advice;
}

std::string step_changed(std::size_t number, const char* how) {
  return format_text("step %zu %s", number, how);
}

}  // namespace lapedit::messages
